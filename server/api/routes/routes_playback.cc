// /v1/sessions/{id}: step, play, pause, reset, seek.
#include <cmath>

#include "engine/scene/json/json_write.h"
#include "server/api/requests.h"
#include "server/api/session_answers.h"

namespace truestep {

namespace json = boost::json;
using net::Method;
using net::Request;
using net::Response;

namespace {

constexpr uint64_t kMostSteps = 1'000'000'000;  // per request

Error too_many_steps(const char* pointer) {
  return {"bad_request",
          "a request may do at most 1e9 steps",
          {{pointer, "out_of_range", "this is more than 1e9 steps", "", "0 to 1e9 steps", "", ""}}};
}

// The step that {"steps": n | "seconds": s | "until": t} leads to.
uint64_t step_target(const json::object& body, const Session& s) {
  if (body.contains("steps") + body.contains("seconds") + body.contains("until") > 1)
    throw Error("bad_request", "the step request has faults",
                {{"", "inconsistent", "give exactly one of steps, seconds and until", "", "", "", ""}});
  const double now = static_cast<double>(s.step_index()), dt = s.world().dt();
  if (body.contains("from_step")) {
    const uint64_t from = integer_member(body, "from_step", kMostStep);
    if (from != s.step_index()) {
      throw Error("step_conflict", "the session is at step " + std::to_string(s.step_index()),
                  {{"/from_step", "precondition", "the session is at another step",
                    write_json(body.at("from_step")), std::to_string(s.step_index()), "", ""}});
    }
  }
  double steps = 1;
  if (body.contains("steps")) steps = static_cast<double>(integer_member(body, "steps", kMostSteps));
  if (body.contains("seconds")) steps = std::round(number_member(body, "seconds", 0, 1e9) / dt);
  if (body.contains("until"))
    steps = std::max(0.0, std::round(number_member(body, "until", 0, 1e9) / dt) - now);
  if (steps > kMostSteps) throw too_many_steps(body.contains("until") ? "/until" : "/seconds");
  return s.step_index() + static_cast<uint64_t>(steps);
}

// The clock after a run of steps, or why the run stopped early.
Task<Response> after_run(App& app, const Request& request, EntryPtr entry, JobPtr job) {
  co_return co_await with_session(app, entry, [&](SessionEntry& e) {
    if (e.session.failure()) return instability(request, e.session);
    if (job->end == Job::End::cancelled) return cut_short(app, request, e);
    return json_response(describe_clock(e));
  });
}

Task<Response> step(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const json::object body = object_body_of(request, {"steps", "seconds", "until", "from_step"});
  Aim aim = [&body](SessionEntry& e) { return step_target(body, e.session); };
  const JobPtr job = co_await app.runner.run_to(entry, Job::Kind::step, std::move(aim));
  co_return co_await after_run(app, request, entry, job);
}

Task<Response> play(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const json::object body = object_body_of(request, {"speed", "keep_running"});
  const bool keep = boolean_member(body, "keep_running");
  co_return co_await with_session(app, entry, [&](SessionEntry& e) {
    if (e.session.failure()) return instability(request, e.session);
    e.session.play(body.contains("speed")
                       ? number_member(body, "speed", Session::kLeastSpeed, Session::kMostSpeed)
                       : 1.0);
    e.played(keep);
    app.runner.keep_playing(entry);
    e.publish();
    return json_response(describe_clock(e));
  });
}

uint64_t seek_target(const json::object& body, const Session& session) {
  if (body.contains("step")) return integer_member(body, "step", kMostSteps);
  const double steps = std::round(number_member(body, "time", 0, 1e9) / session.world().dt());
  if (steps > kMostSteps) throw too_many_steps("/time");
  return static_cast<uint64_t>(steps);
}

Task<Response> seek(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const json::object body = object_body_of(request, {"step", "time"});
  if (body.contains("step") == body.contains("time"))
    throw Error(
        "bad_request", "give step or time",
        {{"", body.empty() ? "missing" : "inconsistent", "give step or time", "", "step, time", "", ""}});
  Aim aim = [&body](SessionEntry& e) { return seek_target(body, e.session); };
  const JobPtr job = co_await app.runner.run_to(entry, Job::Kind::seek, std::move(aim));
  co_return co_await after_run(app, request, entry, job);
}

Task<Response> pause(App& app, const Request& request) {
  object_body_of(request, {});
  EntryPtr entry = co_await session_of(app, request);
  co_return co_await with_session(app, entry, [&app](SessionEntry& e) {
    e.session.pause();
    app.runner.interrupt(e);
    e.publish();
    return json_response(describe_clock(e));
  });
}

Task<Response> reset(App& app, const Request& request) {
  object_body_of(request, {});
  EntryPtr entry = co_await session_of(app, request);
  const auto to_start = [](SessionEntry& e) { e.session.reset(); };
  co_await interrupt_and_call(app, entry, to_start);
  co_return co_await with_session(app, entry,
                                  [](SessionEntry& e) { return json_response(describe_clock(e)); });
}

}  // namespace

void add_playback_routes(net::Router& router, App& app) {
  const std::string session = "/v1/sessions/{id}";
  router.add(Method::post, session + "/step",
             "Steps: {\"steps\": n | \"seconds\": s | \"until\": t, \"from_step\"?: k}",
             [&app](const Request& r) { return once(app, r, [&app, &r] { return step(app, r); }); });
  router.add(Method::post, session + "/play",
             "Plays at speed times real time; without \"keep_running\" until its last viewer has left",
             [&app](const Request& r) { return play(app, r); });
  router.add(Method::post, session + "/pause", "Stops playing and any requested steps",
             [&app](const Request& r) { return pause(app, r); });
  router.add(Method::post, session + "/reset", "Returns to step 0; the journal is cleared",
             [&app](const Request& r) { return reset(app, r); });
  router.add(Method::post, session + "/seek", "Goes to a step or time of this run, exactly",
             [&app](const Request& r) { return seek(app, r); });
}

}  // namespace truestep
