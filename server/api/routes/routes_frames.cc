// /v1/sessions/{id}: output - frames, observables, pictures, the stream.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/scene/params/params.h"
#include "engine/scene/params/params_text.h"
#include "engine/sinks/picture/draw/draw_world.h"
#include "engine/sinks/picture/picture.h"
#include "engine/sinks/picture/png.h"
#include "engine/sinks/stream/frame_encoding.h"
#include "server/api/requests.h"
#include "server/stream/stream_client.h"

namespace truestep {

namespace json = boost::json;
using net::Method;
using net::Request;
using net::Response;

namespace {

[[noreturn]] void refuse_choice(const char* pointer, const std::string& sentence, std::string_view value,
                                const std::vector<std::string>& names) {
  throw Error("bad_request", sentence,
              {{pointer, "unknown_choice", sentence, '"' + std::string(value.substr(0, 60)) + '"',
                join_names(names), nearest_name(value, names), ""}});
}

// Names of PictureLook::View, from `all` on.
const std::vector<std::string> kViews{"all", "front", "side", "top"};

std::optional<PictureLook::View> view_of(std::optional<std::string_view> given) {
  const auto at = std::find(kViews.begin(), kViews.end(), given.value_or(""));
  if (at == kViews.end()) return std::nullopt;
  return static_cast<PictureLook::View>(1 + (at - kViews.begin()));
}

// "ex,ey,ez,tx,ty,tz" in m.
std::optional<DrawCamera> camera_of(std::optional<std::string_view> given) {
  if (!given) return std::nullopt;
  const std::string_view text = *given;
  double v[6];
  const char *at = text.data(), *end = at + text.size();
  for (int i = 0; i < 6; ++i) {
    const auto [next, error] = std::from_chars(at, end, v[i]);
    const bool last = i == 5;
    if (error != std::errc() || !std::isfinite(v[i]) || (last ? next != end : next == end || *next != ',')) {
      throw Error("bad_request", "a camera is six numbers, eye x,y,z and target x,y,z, or a view",
                  {{"?camera", "wrong_type", "a camera is six numbers or a view",
                    '"' + std::string(text.substr(0, 60)) + '"', "ex,ey,ez,tx,ty,tz; " + join_names(kViews),
                    nearest_name(text, kViews), "m"}});
    }
    at = next + 1;
  }
  return DrawCamera{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, std::nullopt, 40};
}

enum class Media : uint8_t { json, protobuf };

Media media_of(const Request& request) {
  const std::string_view accept = request.header("accept");
  if (accept.find("application/x-protobuf") != std::string_view::npos) return Media::protobuf;
  if (!accept.empty() && !request.accepts("application/json")) {
    throw Error("not_acceptable", "frames are available as application/json or application/x-protobuf");
  }
  return Media::json;
}

// The fields of the systems that a request asks for; JSON gives f64 fields at full precision.
std::vector<WireField> fields_of(const Request& request, const World& world, Media media) {
  return wire_fields(world, query_list(request, "fields"), query_list(request, "systems"),
                     media == Media::json ? WireEncoding::f64 : WireEncoding::f32);
}

std::string encode(const Frame& frame, std::span<const WireField> fields, Media media) {
  if (media == Media::json) return encode_json(frame, fields);
  const auto blocks = encode_blocks(frame, fields);
  // A polled frame is the bare Frame message, without the stream's envelope.
  return encode_frame_fields(frame, {}) + *blocks;
}

const char* media_type(Media media) {
  return media == Media::json ? "application/json" : "application/x-protobuf";
}

// The newest frame. While the session does not move, the answer is made once and shared.
Response latest_frame(SessionEntry& e, const Request& request, Media media) {
  const std::string key(request.target);
  const uint64_t version = e.version.load(std::memory_order_acquire);
  CachedAnswer& c = e.cached_frame;
  if (c.version == version && c.key == key && c.content_type == media_type(media)) {
    return Response::shared(c.body, c.content_type, c.etag);
  }
  const auto fields = fields_of(request, e.session.world(), media);
  const FramePtr frame = e.session.frame(request_for(fields, FrameRequest::Extras::state_hash));
  c = {key, version, std::make_shared<const std::string>(encode(*frame, fields, media)), media_type(media),
       '"' + hex64(frame->state_hash.value()) + '-' + std::to_string(frame->step) + '"'};
  return Response::shared(c.body, c.content_type, c.etag);
}

// The state at an earlier step, computed without holding the session's lock.
WorldState state_of(SessionEntry& entry, uint64_t step) {
  std::unique_lock lock(entry.mutex);
  entry.acknowledge();
  if (step > entry.session.step_index()) throw Error("not_found", "the session has not reached this step");
  const Past past = entry.session.past(step);
  lock.unlock();
  return past.compute();
}

Task<Response> frame_at(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const Media media = media_of(request);
  const std::string_view which = request.param("step");
  if (which == "latest") {
    co_return co_await with_session(app, entry,
                                    [&](SessionEntry& e) { return latest_frame(e, request, media); });
  }
  uint64_t step = 0;
  const auto [end, error] = std::from_chars(which.data(), which.data() + which.size(), step);
  if (error != std::errc() || end != which.data() + which.size())
    throw Error("not_found", "a frame is identified by its step, or by latest");
  auto compute = [&] {
    const WorldState state = state_of(*entry, step);
    const auto fields = fields_of(request, entry->session.world(), media);
    FramePtr frame;
    {
      const std::lock_guard lock(entry->mutex);
      frame = entry->session.frame_of(state, request_for(fields, FrameRequest::Extras::state_hash));
    }
    return Response::text(encode(*frame, fields, media), media_type(media));
  };
  co_return co_await app.runner.long_work(std::move(compute));
}

// Polling: frames after a step, waiting up to `wait` seconds for the first one.
Task<Response> poll(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const Media media = media_of(request);
  const bool any_step = !request.query_value("after");
  const uint64_t after = query_integer(request, "after", 0, 0, kMostStep);
  const uint64_t limit = query_integer(request, "limit", 16, 1, 1024);
  const double wait = query_number(request, "wait", 0, 60);
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(wait));
  while (true) {
    const uint64_t seen = entry->changed.version();
    Response response = co_await with_session(app, entry, [&](SessionEntry& e) {
      const auto fields = fields_of(request, e.session.world(), media);
      const FrameRequest wanted = request_for(fields, FrameRequest::Extras::state_hash);
      // The first poll makes the session keep frames for later ones.
      if (!e.poll || e.poll->expired() || e.poll->request().fields != wanted.fields) {
        if (e.poll) e.session.remove_sink(e.poll.get());
        e.poll = std::make_shared<PollSink>(wanted);
        e.session.add_sink(e.poll);
      }
      e.poll->touch();
      std::vector<FramePtr> frames = e.poll->after(any_step ? 0 : after, limit);
      const uint64_t now = e.session.step_index();
      if (frames.empty() && (any_step || now > after)) frames.push_back(e.session.frame(wanted));
      if (frames.empty()) return Response(204);
      if (media == Media::protobuf) {
        // One frame per message: the client asks again for the next.
        return Response::text(encode(*frames.front(), fields, media), media_type(media));
      }
      std::string body = "{\"frames\":[";
      for (size_t i = 0; i < frames.size(); ++i) body += (i ? "," : "") + encode(*frames[i], fields, media);
      body += "],\"last_step\":" + std::to_string(frames.back()->step) +
              ",\"dropped\":" + std::to_string(e.poll->dropped()) + "}";
      return Response::json(std::move(body));
    });
    if (response.status != 204 || Clock::now() >= deadline || entry->removed) co_return response;
    co_await entry->changed.wait(seen, deadline);
    if (app.server && app.server->draining()) co_return response;
  }
}

void append_csv_number(std::string& out, double v) {
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, v).ptr);
}

// The series kept by the session, or the present values when the scene names no observables.
Response observables(SessionEntry& e, const std::vector<std::string>& names, size_t max_points, bool csv) {
  const Session& s = e.session;
  std::vector<std::string> columns, units;
  std::vector<std::vector<double>> values;
  std::vector<uint64_t> steps;
  const auto wanted = [&](std::string_view name) {
    return names.empty() ||
           std::any_of(names.begin(), names.end(), [&](const std::string& n) { return selects(n, name); });
  };
  const Observables current = s.observe();
  if (s.series().active() && !s.series().steps().empty()) {
    const Series& series = s.series();
    const size_t every =
        std::max<size_t>(1, (series.steps().size() + max_points - 1) / std::max<size_t>(1, max_points));
    for (size_t i = 0; i < series.steps().size(); i += every) steps.push_back(series.steps()[i]);
    for (size_t k = 0; k < series.names().size(); ++k) {
      if (!wanted(series.names()[k])) continue;
      columns.push_back(series.names()[k]);
      units.push_back(series.units()[k]);
      auto& column = values.emplace_back();
      for (size_t i = 0; i < series.steps().size(); i += every) column.push_back(series.values(k)[i]);
    }
  } else {
    steps.push_back(s.step_index());
    for (const Observation& o : current.rows()) {
      if (!wanted(o.name)) continue;
      columns.push_back(o.name);
      units.push_back(o.unit);
      values.push_back({o.value});
    }
  }
  if (columns.empty() && !names.empty()) {
    std::vector<Issue> issues;
    const auto known = s.world().known_observables();
    for (const std::string& n : names) {
      if (auto fault = unknown_observable(n, "?names", known)) issues.push_back(std::move(*fault));
    }
    if (!issues.empty()) throw Error("bad_request", "no observable has this name", std::move(issues));
  }
  const double dt = s.world().dt();
  if (csv) {
    std::string out = "step,time";
    for (const std::string& c : columns) out += "," + c;
    out += "\n";
    for (size_t i = 0; i < steps.size(); ++i) {
      out += std::to_string(steps[i]) + ",";
      append_csv_number(out, static_cast<double>(steps[i]) * dt);
      for (const auto& column : values) {
        out += ",";
        append_csv_number(out, column[i]);
      }
      out += "\n";
    }
    return Response::text(std::move(out), "text/csv; charset=utf-8");
  }
  json::object series;
  json::object unit_of;
  for (size_t k = 0; k < columns.size(); ++k) {
    json::array a;
    for (const double v : values[k]) a.push_back(std::isfinite(v) ? json::value(v) : json::value(nullptr));
    series[columns[k]] = std::move(a);
    unit_of[columns[k]] = units[k];
  }
  json::array step_list, time_list;
  for (const uint64_t n : steps)
    step_list.emplace_back(n), time_list.emplace_back(static_cast<double>(n) * dt);
  json::object latest;
  for (const Observation& o : current.rows()) {
    if (wanted(o.name)) latest[o.name] = std::isfinite(o.value) ? json::value(o.value) : json::value(nullptr);
  }
  return json_response(json::object{{"step", s.step_index()},
                                    {"latest", std::move(latest)},
                                    {"units", std::move(unit_of)},
                                    {"series", json::object{{"step", std::move(step_list)},
                                                            {"time", std::move(time_list)},
                                                            {"values", std::move(series)}}}});
}

Wish marks_of(const Request& request) {
  Wish marks = Wish::none;
  for (const std::string& part : query_list(request, "show")) {
    if (part != "contacts" && part != "joints")
      refuse_choice("?show", "a picture cannot show this", part, {"contacts", "joints"});
    marks = marks | (part == "contacts" ? Wish::contacts : Wish::joints);
  }
  return marks;
}

PictureLook look_of(const Request& request) {
  PictureLook look;
  look.marks = marks_of(request);
  if (const auto color = request.query_value("color_by")) look.color_by = std::string(*color);
  const std::string_view theme = request.query_value("theme").value_or("light");
  if (theme != "light" && theme != "dark")
    refuse_choice("?theme", "a picture has no such theme", theme, {"light", "dark"});
  look.theme = theme == "dark" ? PictureLook::Theme::dark : PictureLook::Theme::light;
  look.view = view_of(request.query_value("camera")).value_or(PictureLook::View::scene);
  return look;
}

/// In pixels, from "size=800x600" or from width and height.
struct PictureSize {
  int width = 800, height = 600;
};
PictureSize size_of(const Request& request) {
  constexpr int kMin = PictureRenderer::kMinSide, kMax = PictureRenderer::kMaxSide;
  const auto size = request.query_value("size");
  if (!size) {
    const auto side = [&](const char* name, int fallback) {
      return static_cast<int>(query_integer(request, name, static_cast<uint64_t>(fallback), kMin, kMax));
    };
    return {side("width", 800), side("height", 600)};
  }
  PictureSize out;
  const char* end = size->data() + size->size();
  const auto w = std::from_chars(size->data(), end, out.width);
  const bool crossed = w.ec == std::errc() && w.ptr != end && *w.ptr == 'x';
  const auto h = crossed ? std::from_chars(w.ptr + 1, end, out.height) : w;
  const auto fits = [](int n) { return n >= kMin && n <= kMax; };
  const bool alone = !request.query_value("width") && !request.query_value("height");
  if (!crossed || h.ec != std::errc() || h.ptr != end || !fits(out.width) || !fits(out.height) || !alone) {
    throw Error(alone ? "bad_request" : "invalid",
                "size must be WIDTHxHEIGHT in pixels, instead of width and height",
                {{"?size", alone ? "out_of_range" : "inconsistent", "a size is two numbers of pixels",
                  '"' + std::string(size->substr(0, 60)) + '"', "16x16 to 4096x4096", "", ""}});
  }
  return out;
}

Task<Response> picture(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const auto [width, height] = size_of(request);
  PictureLook look = look_of(request);
  look.trails = entry->trails;
  std::optional<DrawCamera> camera;
  if (look.view == PictureLook::View::scene) camera = camera_of(request.query_value("camera"));
  // A session's world never changes.
  if (look.color_by) require_color(entry->session.world(), *look.color_by);
  std::optional<uint64_t> step;
  if (request.query_value("step")) step = query_integer(request, "step", 0, 0, kMostStep);
  DrawList list;
  std::string etag;
  const auto draw = [&](SessionEntry& e, const WorldState& state) {
    const World& world = e.session.world();
    list = draw_list_of(world, *e.session.frame_of(state, picture_request(world, look)), look);
    return Response();
  };
  if (step) {
    auto compute = [&] { return draw(*entry, state_of(*entry, *step)); };
    co_await app.runner.long_work(std::move(compute));
  } else {
    co_await with_session_on_worker(app, entry, [&](SessionEntry& e) { return draw(e, e.session.state()); });
  }
  if (camera) list.camera = camera;
  auto draw_it = [&list, w = width, h = height] {
    thread_local PictureRenderer renderer(w, h);
    renderer.resize(w, h);
    const auto png = encode_png(renderer.render_rgba(list), w, h);
    Response r = Response::text({reinterpret_cast<const char*>(png.data()), png.size()}, "image/png");
    r.header("Cache-Control", "no-store");
    return r;
  };
  co_return co_await app.runner.draw(std::move(draw_it));
}

}  // namespace

void add_frame_routes(net::Router& router, App& app) {
  const std::string session = "/v1/sessions/{id}";
  router.add(Method::get, session + "/frames",
             "Frames after a step; waits up to `wait` seconds for one; 204 when there is none",
             [&app](const Request& r) { return poll(app, r); });
  router.add(Method::get, session + "/frames/{step}", "The frame of a step, or the latest",
             [&app](const Request& r) { return frame_at(app, r); });
  router.add(
      Method::get, session + "/observables",
      "Energies, momenta, probes: latest values and series, JSON or CSV", [&app](const Request& r) {
        const auto names = query_list(r, "names");
        const auto max_points = static_cast<size_t>(query_integer(r, "max_points", 4096, 1, 1'000'000));
        const bool csv = r.header("accept").find("text/csv") != std::string_view::npos;
        return with_session(app, r, [=](SessionEntry& e) { return observables(e, names, max_points, csv); });
      });
  router.add(Method::get, session + "/picture.png", "A picture of the present state or of an earlier step",
             [&app](const Request& r) { return picture(app, r); });
  router
      .websocket(session + "/stream", "Frames, events and control over a WebSocket",
                 {"truestep.v1.proto", "truestep.v1.json"},
                 [&app](const Request& r) {
                   EntryPtr entry = app.store.find(r.param("id"), r.caller);
                   if (!entry) throw Error("creating", "this session is being saved to disk; try again");
                   return make_stream(std::move(entry), app.runner, app.stream_stats);
                 })
      .before_open = [&app](const Request& r) -> Task<> { co_await session_of(app, r); };
}

}  // namespace truestep
