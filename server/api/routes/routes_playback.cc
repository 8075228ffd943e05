// /v1/sessions/{id}: step, play, pause, reset, seek.
#include <cmath>

#include "server/api/requests.h"
#include "server/api/session_answers.h"

namespace truestep {

namespace json = boost::json;
using net::Method;
using net::Request;
using net::Response;

namespace {

constexpr const char* kProtobuf = "application/x-protobuf";

// The answer to a run of steps, or why the run stopped early.
Task<Response> after_run(App& app, const Request& request, EntryPtr entry, JobPtr job,
                         const AnswerOfSession& answer) {
  co_return co_await with_session(app, entry, [&](SessionEntry& e) {
    if (job->end == Job::End::reached) return answer(e);
    if (e.session.failure()) return instability(request, e.session);
    return cut_short(app, request, e);
  });
}

Task<Response> step(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const bool protobuf = request.header("accept").find(kProtobuf) != std::string_view::npos;
  using Form = StepRequest::Form;
  StepRequest step(json_object_body(request), protobuf ? Form::protobuf : Form::json);
  Aim aim = [&step](SessionEntry& e) { return step.begin(e); };
  std::function<void(SessionEntry&)> reached = [&step](SessionEntry& e) { step.reached(e); };
  const JobPtr job = co_await app.runner.run_to(entry, Job::Kind::step, std::move(aim), std::move(reached));
  const AnswerOfSession answer = [&](SessionEntry&) {
    return protobuf ? Response::text(step.answer_bytes(""), kProtobuf) : Response::json(step.json());
  };
  co_return co_await after_run(app, request, entry, job, answer);
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
  constexpr uint64_t kMostSteps = StepRequest::kMostSteps;
  if (body.contains("step")) return integer_member(body, "step", kMostSteps);
  const double steps = std::round(number_member(body, "time", 0, 1e9) / session.world().dt());
  if (steps > kMostSteps) throw StepRequest::too_many("/time");
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
  const AnswerOfSession clock = [](SessionEntry& e) { return json_response(describe_clock(e)); };
  co_return co_await after_run(app, request, entry, job, clock);
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
  router.add(
      Method::post, session + "/step",
      "Acts, steps and looks: {\"commands\": [...], \"steps\": n, \"observe\": [names], \"fields\": [names]}",
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
