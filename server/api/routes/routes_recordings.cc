// /v1/recordings: every recording in the data folder; /v1/sessions/{id}/recording: a session's newest.
#include "server/api/recordings.h"
#include "server/api/requests.h"
#include "server/net/http/problem.h"
#include "server/persistence/recording_catalogue.h"

namespace truestep {

namespace json = boost::json;
using net::Method;
using net::Request;
using net::Response;
namespace {

json::object describe(const RecordingFacts& f) {
  const std::string self = "/v1/recordings/" + f.id;
  json::object o{
      {"id", f.id},
      {"session", f.session},
      {"title", f.title},
      {"state", state_name(f.state)},
      {"frames", f.frames},
      {"bytes", static_cast<uint64_t>(f.bytes)},
      {"created", f.created},
      {"links",
       json::object{{"self", self}, {"file", self + "/file"}, {"session", "/v1/sessions/" + f.session}}}};
  if (!f.note.empty()) o["note"] = f.note;
  return o;
}

// While it is being written, 409 with a link to finish it; the file afterwards.
Response file_of(const App& app, const Request& request, const RecordingFacts& f) {
  if (f.state == RecordingFate::live) {
    return net::problem(
        request, "conflict", "the recording is being written; finish it first", {},
        json::object{{"frames", f.frames}, {"finish", "/v1/sessions/" + f.session + "/recording/finish"}});
  }
  Response r = Response::file(app.recordings.place(f.id).try_open(O_RDONLY).release(), "application/x-hdf5");
  r.header("Content-Disposition", "attachment; filename=\"" + f.id + ".vtkhdf\"");
  return r;
}

Task<Response> session_recording(App& app, const Request& request) {
  // Reading a recording does not restore its session.
  const std::string id(request.param("id"));
  const auto last = app.recordings.newest(id);
  if (last && last->state != RecordingFate::live && last->state != RecordingFate::incomplete &&
      request.caller.may_see(last->owner))
    co_return file_of(app, request, *last);
  const EntryPtr entry = co_await session_of(app, request);
  co_return co_await with_session_on_worker(app, entry, [&](SessionEntry& e) {
    auto facts = app.recordings.newest(e.id);
    if (!facts)
      throw Error("not_found", "this session records nothing; give its scene a \"recording\" or POST one");
    // A recording that ended on a full disk is brought into the form that readers expect.
    if (facts->state == RecordingFate::incomplete && app.recordings.live(facts->id))
      facts = finish_recording(app, e);
    return file_of(app, request, *facts);
  });
}

Task<Response> start(App& app, const Request& request) {
  const json::object body = object_body_of(request, {"every", "fields", "precision"});
  const EntryPtr entry = co_await session_of(app, request);
  co_return co_await with_session_on_worker(app, entry, [&app, &body](SessionEntry& e) {
    Response answer = json_response(describe(start_recording(app, e, body)), 201);
    answer.header("Location", "/v1/sessions/" + e.id + "/recording");
    return answer;
  });
}

Task<Response> finish(App& app, const Request& request) {
  object_body_of(request, {});
  const EntryPtr entry = co_await session_of(app, request);
  co_return co_await with_session_on_worker(app, entry, [&app](SessionEntry& e) {
    const RecordingFacts f = finish_recording(app, e);
    json::object o{{"frames", f.frames},
                   {"complete", f.state != RecordingFate::incomplete},
                   {"recording", "/v1/sessions/" + e.id + "/recording"},
                   {"id", f.id}};
    if (!f.note.empty()) o["note"] = f.note;
    return json_response(o);
  });
}

Response page(const App& app, const Request& request) {
  const uint64_t limit = query_integer(request, "limit", 100, 1, 1000);
  const std::string_view after = request.query_value("page_token").value_or("");
  if (!after.empty() && !is_recording_id(after))
    throw Error("bad_request", "a page_token must come from the previous page",
                {{"?page_token", "wrong_type", "not a valid page_token", "", "a recording's id", "", ""}});
  json::array list;
  const auto all = app.recordings.list(after, limit, request.caller);
  for (const RecordingFacts& f : all) list.push_back(describe(f));
  json::object o{{"recordings", std::move(list)}};
  if (all.size() == limit) o["next_page_token"] = all.back().id;
  return json_response(o);
}

RecordingFacts recording_of(const App& app, const Request& request) {
  return app.recordings.find(request.param("rid"), request.caller);
}

Task<Response> remove(App& app, const Request& request) {
  const RecordingFacts f = recording_of(app, request);
  auto work = [&app, id = f.id] {
    app.recordings.remove(id);
    return Response(204);
  };
  co_return co_await offload(app.runner.pool(), std::move(work));
}

}  // namespace

void add_recording_routes(net::Router& router, App& app) {
  const std::string path = "/v1/sessions/{id}/recording", one = "/v1/recordings/{rid}";
  router.add(Method::get, path, "The newest recording as HDF5 (H5MD and VTKHDF); 409 while it is written",
             [&app](const Request& r) { return session_recording(app, r); });
  router.add(
      Method::post, path,
      "Begins a recording of a session that runs, described as a scene's \"recording\"; 409 while one runs",
      [&app](const Request& r) { return start(app, r); });
  router.add(Method::delete_, path, "Ends the recording in progress, as finish does: what it holds stays",
             [&app](const Request& r) { return finish(app, r); });
  router.add(Method::post, path + "/finish", "Completes the recording for download",
             [&app](const Request& r) { return finish(app, r); });
  router.add(Method::get, "/v1/recordings",
             "Recordings in the order of their ids, page by page, including those of ended sessions",
             [&app](const Request& r) { return page(app, r); });
  router.add(Method::get, one, "One recording: its session, state, frames and bytes",
             [&app](const Request& r) { return json_response(describe(recording_of(app, r))); });
  router.add(Method::get, one + "/file", "The recording as HDF5; 409 while it is written",
             [&app](const Request& r) { return file_of(app, r, recording_of(app, r)); });
  router.add(Method::delete_, one, "Removes a recording for good; 409 while it is written",
             [&app](const Request& r) { return remove(app, r); });
}

}  // namespace truestep
