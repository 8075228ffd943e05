// /v1/sessions: create, step, play, commands, the past.
#include <cmath>

#include "engine/base/hash.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json.h"
#include "engine/scene/json_write.h"
#include "engine/session/commands.h"
#include "server/api/describe.h"
#include "server/api/recordings.h"
#include "server/api/requests.h"
#include "server/net/problem.h"

namespace truestep {

namespace json = boost::json;
namespace asio = boost::asio;
using net::Method;
using net::Request;
using net::Response;

namespace {

json::object links_of(const std::string& id) {
  const std::string self = "/v1/sessions/" + id;
  return {{"self", self},
          {"step", self + "/step"},
          {"play", self + "/play"},
          {"pause", self + "/pause"},
          {"reset", self + "/reset"},
          {"frames", self + "/frames"},
          {"latest_frame", self + "/frames/latest"},
          {"observables", self + "/observables"},
          {"plan", self + "/plan"},
          {"commands", self + "/commands"},
          {"snapshots", self + "/snapshots"},
          {"picture", self + "/picture.png"},
          {"recording", self + "/recording"},
          {"stream", self + "/stream"},
          {"viewer", "/?session=" + id}};
}

// Under the entry's lock.
json::object describe_session(SessionEntry& e) {
  const Session& s = e.session;
  json::object o{{"id", e.id},
                 {"name", s.world().scene().header.name},
                 {"step", s.step_index()},
                 {"time", s.time()},
                 {"dt", s.world().dt()},
                 {"status", s.failure()   ? "unstable"
                            : s.playing() ? "playing"
                                          : "paused"},
                 {"speed", s.speed()},
                 {"skipped_steps", s.skipped_steps()},
                 {"frames_built", s.frames_built()},
                 {"state_hash", hex64(s.hash())}};
  json::array systems;
  for (size_t i = 0; i < s.world().size(); ++i) {
    json::array fields;
    for (const FieldInfo& f : s.world().system(i).fields()) {
      fields.push_back(json::object{
          {"name", f.name}, {"unit", f.unit}, {"width", f.width}, {"type", scalar_name(f.type)}});
    }
    systems.push_back(json::object{{"id", s.world().id(i)},
                                   {"type", s.world().scene().systems[i].row->type},
                                   {"fields", std::move(fields)}});
  }
  o["systems"] = std::move(systems);
  const SceneHeader& header = s.world().scene().header;
  if (!header.title.empty()) o["title"] = header.title;
  if (!header.teaches.empty()) o["teaches"] = header.teaches;
  json::object viewer;
  if (!header.viewer.color_by.empty()) viewer["color_by"] = header.viewer.color_by;
  if (const auto& c = header.viewer.camera) {
    const auto vector = [](const Vec3& v) { return json::array{v.x, v.y, v.z}; };
    viewer["camera"] = json::object{
        {"eye", vector(c->eye)}, {"target", vector(c->target)}, {"up", vector(c->up)}, {"fov", c->fov}};
  }
  if (!viewer.empty()) o["viewer"] = std::move(viewer);
  if (const auto& f = s.failure()) {
    o["instability"] = json::object{{"system", f->system},
                                    {"quantity", f->quantity},
                                    {"index", f->index},
                                    {"detail", f->detail},
                                    {"last_good_step", f->last_good_step}};
    if (f->suggested_dt) o["instability"].as_object()["suggested_dt"] = *f->suggested_dt;
  }
  o["links"] = links_of(e.id);
  return o;
}

json::object describe_clock(const SessionEntry& e) {
  const Session& s = e.session;
  return {{"id", e.id},         {"step", s.step_index()},
          {"time", s.time()},   {"status", s.failure() ? "unstable" : s.playing() ? "playing" : "paused"},
          {"speed", s.speed()}, {"state_hash", hex64(s.hash())}};
}

Response instability(const Request& request, const Session& s) {
  const Failure& f = *s.failure();
  json::object extra{{"last_good_step", f.last_good_step},
                     {"system", f.system},
                     {"quantity", f.quantity},
                     {"index", f.index}};
  if (f.suggested_dt) extra["suggested_dt"] = *f.suggested_dt;
  return net::problem(request, "instability", f.detail, {}, extra);
}

// A scene, or {"gallery": name}.
json::value scene_document(json::value body) {
  if (!body.is_object() || !body.as_object().contains("gallery")) return body;
  const json::object& o = body.as_object();
  const json::value& name = o.at("gallery");
  std::vector<Issue> issues;
  for (const auto& [key, value] : o) {
    if (key != "gallery")
      issues.push_back({"/" + std::string(key), "unknown_key", "beside \"gallery\" nothing else is read", "",
                        "gallery", "", ""});
  }
  const GalleryScene* g =
      name.is_string() ? find_gallery_scene({name.as_string().data(), name.as_string().size()}) : nullptr;
  if (!g) {
    std::string all;
    for (const GalleryScene& s : gallery()) all += (all.empty() ? "" : ", ") + std::string(s.name);
    issues.push_back({"/gallery", "unknown_choice", "the gallery has no such scene",
                      name.is_string() ? write_json(name) : "", all, "", ""});
  }
  if (!issues.empty()) throw Error("scene_invalid", "there is no such gallery scene", std::move(issues));
  return parse_json(g->text);
}

Response created(const RememberedAnswer& a) {
  Response r = Response::json(a.body, a.status);
  r.header("Location", a.location);
  return r;
}

// The handlers that create: on a worker, for building a world takes as long as its scene is large.
asio::awaitable<Response> create(App& app, const Request& request, std::string id, std::string key) {
  json::value document = scene_document(json_body(request));
  Hasher hasher;
  hasher.text(request.body);
  if (!key.empty()) {
    if (key.size() > 255) throw Error("bad_request", "an Idempotency-Key has at most 255 characters");
    if (const auto before = app.idempotency.begin(key, hasher.value())) co_return created(*before);
  }
  try {
    auto build = [&app, id, document = std::move(document)] {
      SessionStore::Created c = app.store.create(document, id);
      const std::lock_guard lock(c.entry->mutex);
      if (c.how == SessionStore::Created::How::made) attach_recording(app, *c.entry);
      RememberedAnswer answer;
      answer.status = c.how == SessionStore::Created::How::made ? 201 : 200;
      answer.body = write_json(describe_session(*c.entry));
      answer.location = "/v1/sessions/" + c.entry->id;
      return answer;
    };
    auto made = co_await net::offload(app.runner.pool(), std::move(build));
    made.request_hash = hasher.value();
    if (!key.empty()) app.idempotency.remember(key, made);
    co_return created(made);
  } catch (...) {
    if (!key.empty()) app.idempotency.forget(key);
    throw;
  }
}

// The step that {"steps": n | "seconds": s | "until": t} leads to.
uint64_t step_target(const json::object& body, const Session& s) {
  std::vector<Issue> issues;
  int given = 0;
  for (const auto& [key, value] : body) {
    if (key == "steps" || key == "seconds" || key == "until")
      ++given;
    else if (key != "from_step")
      issues.push_back({"/" + std::string(key), "unknown_key", "this is no member of a step request", "",
                        "steps, seconds, until, from_step", "", ""});
  }
  if (given > 1)
    issues.push_back({"", "inconsistent", "give one of steps, seconds and until", "", "", "", ""});
  if (!issues.empty()) throw Error("bad_request", "the step request has faults", std::move(issues));
  const double now = static_cast<double>(s.step_index()), dt = s.world().dt();
  if (body.contains("from_step")) {
    const double from = number_member(body, "from_step", 0, 9e15);
    if (from != now) {
      throw Error("step_conflict", "the session is at step " + std::to_string(s.step_index()),
                  {{"/from_step", "precondition", "the session is at another step",
                    write_json(body.at("from_step")), std::to_string(s.step_index()), "", ""}});
    }
  }
  double steps = 1;
  if (body.contains("steps")) steps = number_member(body, "steps", 0, 1e9);
  if (body.contains("seconds")) steps = std::round(number_member(body, "seconds", 0, 1e9) / dt);
  if (body.contains("until"))
    steps = std::max(0.0, std::round(number_member(body, "until", 0, 1e9) / dt) - now);
  if (steps != std::floor(steps) || steps > 1e9) {
    throw Error(
        "bad_request", "a request does a whole number of steps, at most 1e9",
        {{"/steps", "out_of_range", "the value is outside the allowed range", "", "0 to 1e9", "", ""}});
  }
  return s.step_index() + static_cast<uint64_t>(steps);
}

asio::awaitable<Response> step(App& app, const Request& request) {
  EntryPtr entry = app.store.find(request.param("id"));
  const std::string key(request.header("idempotency-key"));
  const json::object body = json_object_body(request);
  Hasher hasher;
  hasher.text(entry->id);
  hasher.text(request.body);
  if (!key.empty()) {
    if (const auto before = app.idempotency.begin(key, hasher.value()))
      co_return Response::json(before->body, before->status);
  }
  try {
    auto find_target = [entry, &body] {
      const std::lock_guard lock(entry->mutex);
      if (!entry->session.failure()) return step_target(body, entry->session);
      return UINT64_MAX;
    };
    const uint64_t target = co_await net::offload(app.runner.pool(), std::move(find_target));
    if (target != UINT64_MAX) co_await app.runner.step_to(entry, target);
    Response response = co_await with_session(app, entry, [&](SessionEntry& e) {
      return e.session.failure() ? instability(request, e.session) : json_response(describe_clock(e));
    });
    if (!key.empty())
      app.idempotency.remember(key,
                               {hasher.value(), response.status, std::string(response.body_bytes()), ""});
    co_return response;
  } catch (...) {
    if (!key.empty()) app.idempotency.forget(key);
    throw;
  }
}

asio::awaitable<Response> play(App& app, const Request& request) {
  EntryPtr entry = app.store.find(request.param("id"));
  const json::object body = json_object_body(request);
  co_return co_await with_session(app, entry, [&](SessionEntry& e) {
    if (e.session.failure()) return instability(request, e.session);
    e.session.play(body.contains("speed") ? number_member(body, "speed", 1e-6, 1000) : 1.0);
    app.runner.keep_playing(entry);
    e.publish();
    return json_response(describe_clock(e));
  });
}

asio::awaitable<Response> seek(App& app, const Request& request) {
  EntryPtr entry = app.store.find(request.param("id"));
  const json::object body = json_object_body(request);
  co_return co_await with_session_on_worker(app, entry, [&](SessionEntry& e) {
    double target = 0;
    if (body.contains("step"))
      target = number_member(body, "step", 0, 1e9);
    else if (body.contains("time"))
      target = std::round(number_member(body, "time", 0, 1e9) / e.session.world().dt());
    else
      throw Error("bad_request", "give step or time",
                  {{"", "missing", "give step or time", "", "step, time", "", ""}});
    e.session.seek(static_cast<uint64_t>(target));
    e.publish();
    return e.session.failure() ? instability(request, e.session) : json_response(describe_clock(e));
  });
}

asio::awaitable<Response> command(App& app, const Request& request) {
  EntryPtr entry = app.store.find(request.param("id"));
  const Command c = read_command(json_body(request));
  co_return co_await with_session(app, entry, [&](SessionEntry& e) {
    const uint64_t sequence = e.session.command(c);
    e.publish();
    return json_response(json::object{{"sequence", sequence}, {"step", e.session.step_index()}}, 202);
  });
}

asio::awaitable<Response> take_snapshot(App& app, const Request& request) {
  EntryPtr entry = app.store.find(request.param("id"));
  co_return co_await with_session_on_worker(app, entry, [](SessionEntry& e) {
    if (e.snapshots.size() >= 64) throw Error("quota_exceeded", "a session keeps at most 64 snapshots");
    const std::string sid = "step-" + std::to_string(e.session.step_index());
    e.snapshots[sid] = std::make_shared<const WorldState>(e.session.state());
    Response r = json_response(
        json::object{{"id", sid}, {"step", e.session.step_index()}, {"state_hash", hex64(e.session.hash())}},
        201);
    r.header("Location", "/v1/sessions/" + e.id + "/snapshots/" + sid);
    return r;
  });
}

std::shared_ptr<const WorldState> snapshot_of(SessionEntry& e, std::string_view sid) {
  const auto it = e.snapshots.find(std::string(sid));
  if (it == e.snapshots.end()) throw Error("not_found", "this session has no such snapshot");
  return it->second;
}

asio::awaitable<Response> branch(App& app, const Request& request) {
  EntryPtr entry = app.store.find(request.param("id"));
  auto copy = [&app, entry] {
    json::value document;
    WorldState state;
    {
      const std::lock_guard lock(entry->mutex);
      document = entry->session.world().scene().canonical();
      state = entry->session.state();
    }
    auto made = app.store.create(document, random_session_id());
    const std::lock_guard lock(made.entry->mutex);
    made.entry->session.restore(std::move(state));
    Response r = json_response(describe_session(*made.entry), 201);
    r.header("Location", "/v1/sessions/" + made.entry->id);
    return r;
  };
  co_return co_await net::offload(app.runner.pool(), std::move(copy));
}

}  // namespace

void add_session_routes(net::Router& router, App& app) {
  const std::string session = "/v1/sessions/{id}";
  router.add(Method::post, "/v1/sessions", "Creates a session from a scene or {\"gallery\": name}",
             [&app](const Request& r) {
               return create(app, r, random_session_id(), std::string(r.header("idempotency-key")));
             });
  router.add(Method::put, session,
             "Creates a session under the client's own UUID; repeating it changes nothing",
             [&app](const Request& r) {
               const std::string id(r.param("id"));
               if (!is_session_id(id))
                 throw Error("bad_request", "a session id is a UUID in lower-case hexadecimal digits");
               return create(app, r, id, "");
             });
  router.add(Method::get, "/v1/sessions", "Sessions in the order of their ids, page by page",
             [&app](const Request& r) {
               const uint64_t limit = std::max<uint64_t>(1, query_integer(r, "limit", 100, 1000));
               json::array list;
               const auto entries = app.store.list(r.query_value("page_token").value_or(""), limit);
               for (const EntryPtr& e : entries)
                 list.push_back(json::object{{"id", e->id}, {"links", links_of(e->id)}});
               json::object o{{"sessions", std::move(list)}};
               if (entries.size() == limit) o["next_page_token"] = entries.back()->id;
               return json_response(o);
             });
  router.add(Method::get, session, "One session: clock, status, systems, links", [&app](const Request& r) {
    return with_session(app, app.store.find(r.param("id")),
                        [](SessionEntry& e) { return json_response(describe_session(e)); });
  });
  router.add(Method::delete_, session, "Ends a session and removes its recording",
             [&app](const Request& r) -> asio::awaitable<Response> {
               EntryPtr entry = app.store.remove(r.param("id"));
               entry->publish();
               co_return co_await with_session_on_worker(app, entry, [](SessionEntry& e) {
                 e.session.pause();
                 discard_recording(e);
                 return Response(204);
               });
             });
  router.add(Method::post, session + "/step",
             "Steps: {\"steps\": n | \"seconds\": s | \"until\": t, \"from_step\"?: k}",
             [&app](const Request& r) { return step(app, r); });
  router.add(Method::post, session + "/play", "Runs in real time times speed",
             [&app](const Request& r) { return play(app, r); });
  router.add(Method::post, session + "/pause", "Stops running", [&app](const Request& r) {
    return with_session(app, app.store.find(r.param("id")), [](SessionEntry& e) {
      e.session.pause();
      e.publish();
      return json_response(describe_clock(e));
    });
  });
  router.add(Method::post, session + "/reset", "Back to step 0; the journal is forgotten",
             [&app](const Request& r) {
               return with_session_on_worker(app, app.store.find(r.param("id")), [](SessionEntry& e) {
                 e.session.reset();
                 e.publish();
                 return json_response(describe_clock(e));
               });
             });
  router.add(Method::post, session + "/seek", "Goes to a step or time of this run, exactly",
             [&app](const Request& r) { return seek(app, r); });
  router.add(Method::post, session + "/branch", "A new session that continues from this one's state",
             [&app](const Request& r) { return branch(app, r); });
  router.add(Method::post, session + "/commands",
             "Push, impulse, drag, release, pin, unpin, set_parameter, spawn, remove",
             [&app](const Request& r) { return command(app, r); });
  router.add(Method::get, session + "/plan",
             "Passes of a step with their share of time, and what was skipped and why",
             [&app](const Request& r) {
               return with_session(app, app.store.find(r.param("id")), [](SessionEntry& e) {
                 return json_response(
                     json::object{{"passes", describe_plan(e.session.world(), e.session.profiles())}});
               });
             });
  router.add(Method::get, session + "/snapshots", "Snapshots that were taken", [&app](const Request& r) {
    return with_session(app, app.store.find(r.param("id")), [](SessionEntry& e) {
      json::array list;
      for (const auto& [sid, state] : e.snapshots)
        list.push_back(json::object{{"id", sid}, {"step", state->step}});
      return json_response(json::object{{"snapshots", std::move(list)}});
    });
  });
  router.add(Method::post, session + "/snapshots", "Takes a snapshot of the present state",
             [&app](const Request& r) { return take_snapshot(app, r); });
  router.add(Method::get, session + "/snapshots/{sid}", "A snapshot's bytes",
             [&app](const Request& r) -> asio::awaitable<Response> {
               const std::string sid(r.param("sid"));
               co_return co_await with_session_on_worker(
                   app, app.store.find(r.param("id")), [&sid](SessionEntry& e) {
                     const auto bytes = snapshot_of(e, sid)->serialize();
                     return Response::text({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                                           "application/octet-stream");
                   });
             });
  router.add(Method::post, session + "/snapshots/{sid}/restore", "Continues from a snapshot",
             [&app](const Request& r) -> asio::awaitable<Response> {
               const std::string sid(r.param("sid"));
               co_return co_await with_session_on_worker(app, app.store.find(r.param("id")),
                                                         [&sid](SessionEntry& e) {
                                                           e.session.restore(*snapshot_of(e, sid));
                                                           e.publish();
                                                           return json_response(describe_clock(e));
                                                         });
             });
}

}  // namespace truestep
