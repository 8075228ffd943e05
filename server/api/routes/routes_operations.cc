// /v1/studies starts an operation; /v1/operations/{id} watches, cancels and reads it.
#include "engine/scene/json/json_write.h"
#include "engine/scene/params/params.h"
#include "engine/session/describe.h"
#include "engine/studies/single_run.h"
#include "server/api/requests.h"

namespace truestep {

namespace json = boost::json;
using net::Method;
using net::Request;
using net::Response;

namespace {

json::object describe_operation(const Operation& o) {
  const OperationView v = o.view();
  const std::string self = "/v1/operations/" + o.id;
  json::object out{{"id", o.id},
                   {"kind", o.request.kind->name},
                   {"status", status_name(v.status)},
                   {"progress", v.progress},
                   {"note", v.note},
                   {"links", json::object{{"self", self},
                                          {"cancel", self + "/cancel"},
                                          {"events", self + "/events"},
                                          {"result", self + "/result"},
                                          {"csv", self + "/result.csv"},
                                          {"svg", self + "/result.svg"}}}};
  if (v.error && v.status == OperationStatus::failed) {
    out["error"] = json::object{{"code", v.error->code()},
                                {"detail", v.error->what()},
                                {"errors", describe_issues(v.error->issues())}};
  }
  if (v.result) out["summary"] = v.result->summary;
  return out;
}

json::object describe_kind(const StudyKind& k) {
  return {{"kind", k.name}, {"sentence", k.sentence}, {"parameters", describe_params(k.table())}};
}

Response accepted(const Operation& o) {
  Response r = json_response(describe_operation(o), 202);
  r.header("Location", "/v1/operations/" + o.id);
  return r;
}

Task<Response> start_run(App& app, const Request& request) {
  auto work = [&app, caller = request.caller](json::value body) {
    body = object_of(std::move(body));
    const std::string text = write_json(body);
    const auto lease = app.assets.resolve(body, app.memory);
    return app.operations.start(read_request_of(run_kind(), body), text, "", caller);
  };
  const OperationPtr o = co_await with_json_body(app, request, std::move(work));
  co_return accepted(*o);
}

// The member "resume", which is taken out; empty when it is absent.
std::string take_resume(json::object& body) {
  const json::value* r = body.if_contains("resume");
  if (!r) return "";
  if (!r->is_string()) {
    throw Error(
        "bad_request", "resume must name an operation",
        {{"/resume", "wrong_type", "the id of an operation must be a text", shorten(*r), "text", "", ""}});
  }
  std::string resume(r->as_string());
  body.erase("resume");
  return resume;
}

Task<Response> start_study(App& app, const Request& request) {
  auto work = [&app, caller = request.caller](json::value sent) {
    json::object body = object_of(std::move(sent));
    const std::string resume = take_resume(body), text = write_json(body);
    json::value resolved = std::move(body);
    const auto lease = app.assets.resolve(resolved, app.memory);
    return app.operations.start(read_study_request(resolved), text, resume, caller);
  };
  const OperationPtr o = co_await with_json_body(app, request, std::move(work));
  co_return accepted(*o);
}

// Server-sent events (WHATWG HTML, section 9.2): "progress" after every change, "end" once, and a comment
// after some silence, so that a client that has left is noticed.
net::StreamBody events_of(OperationPtr operation) {
  struct Position {
    uint64_t seen = UINT64_MAX;
    bool ended = false;
  };
  auto position = std::make_shared<Position>();
  // A coroutine's arguments live as long as it does; a closure's captures would have to be kept alive by
  // hand.
  const auto next = [](OperationPtr o, std::shared_ptr<Position> p) -> Task<std::optional<std::string>> {
    if (p->ended) co_return std::nullopt;
    if (p->seen != UINT64_MAX) {
      const bool changed =
          co_await o->changed.wait(p->seen, std::chrono::steady_clock::now() + std::chrono::seconds(15));
      if (!changed) co_return ": nothing new\n\n";
    }
    p->seen = o->changed.version();
    p->ended = o->view().ended();
    co_return std::string("event: ") + (p->ended ? "end" : "progress") +
        "\ndata: " + write_json(describe_operation(*o)) + "\n\n";
  };
  return {[next, operation = std::move(operation), position] { return next(operation, position); }};
}

std::shared_ptr<const StudyResult> result_of(const App& app, const Request& request) {
  const OperationPtr o = operation_of(app, request);
  const OperationView v = o->view();
  if (v.status == OperationStatus::failed) throw Error(v.error->code(), v.error->what(), v.error->issues());
  if (v.status == OperationStatus::cancelled) throw Error("not_found", "the operation was cancelled");
  if (!v.result) throw Error("conflict", "the operation has not ended; GET /v1/operations/" + o->id);
  return v.result;
}

}  // namespace

void add_operation_routes(net::Router& router, App& app) {
  router.add(Method::get, "/v1/studies", "The kinds of studies and their parameters", [](const Request&) {
    json::array kinds;
    for (const StudyKind& k : study_kinds()) kinds.push_back(describe_kind(k));
    return json_response(json::object{{"studies", std::move(kinds)}});
  });
  router.add(Method::post, "/v1/studies", "Starts a study of a scene: 202 and an operation",
             [&app](const Request& r) { return once(app, r, [&app, &r] { return start_study(app, r); }); });
  router.add(Method::post, "/v1/runs",
             "Runs a scene to its end, or for a duration: 202 and an operation with observables over time",
             [&app](const Request& r) { return once(app, r, [&app, &r] { return start_run(app, r); }); });
  router.add(Method::get, "/v1/operations", "The operations that the server remembers",
             [&app](const Request& r) {
               json::array list;
               for (const OperationPtr& o : app.operations.all(r.caller))
                 list.push_back(describe_operation(*o));
               return json_response(json::object{{"operations", std::move(list)}});
             });
  router.add(Method::get, "/v1/operations/{id}", "State and progress of an operation",
             [&app](const Request& r) { return json_response(describe_operation(*operation_of(app, r))); });
  router.add(Method::delete_, "/v1/operations/{id}", "Cancels and removes an operation",
             [&app](const Request& r) {
               app.operations.remove(operation_of(app, r));
               return Response(204);
             });
  router.add(Method::post, "/v1/operations/{id}/cancel", "Asks an operation to stop",
             [&app](const Request& r) {
               const OperationPtr o = operation_of(app, r);
               object_body_of(r, {});
               o->cancel();
               return json_response(describe_operation(*o));
             });
  router.add(Method::get, "/v1/operations/{id}/events", "Progress as server-sent events",
             [&app](const Request& r) {
               Response out(200);
               out.content_type = "text/event-stream";
               out.header("Cache-Control", "no-store");
               out.body = events_of(operation_of(app, r));
               return out;
             });
  for (const char* name : {"result", "result.json"}) {
    router.add(Method::get, std::string("/v1/operations/{id}/") + name, "The results of a study as JSON",
               [&app](const Request& r) { return json_response(result_json(*result_of(app, r))); });
  }
  router.add(Method::get, "/v1/operations/{id}/result.csv", "The table of a study", [&app](const Request& r) {
    return Response::text(result_csv(result_of(app, r)->table), "text/csv; charset=utf-8");
  });
  router.add(Method::get, "/v1/operations/{id}/result.svg", "The plot of a study", [&app](const Request& r) {
    return Response::text(result_svg(result_of(app, r)->plot), "image/svg+xml");
  });
}

}  // namespace truestep
