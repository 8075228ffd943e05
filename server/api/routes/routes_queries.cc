// POST /v1/sessions/{id}/queries: spatial queries.
#include "engine/session/queries/queries.h"
#include "server/api/requests.h"

namespace truestep {

using net::Request;
using net::Response;

namespace {

// Checked before anything of an array is read.
boost::json::value answer(const Session& session, const boost::json::value& body) {
  constexpr size_t kMostQueries = 1000;
  if (body.is_array() && body.as_array().size() > kMostQueries)
    throw Error("bad_query", "a request may hold at most 1000 queries");
  return answer_queries(session, body);
}

Task<Response> query(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const boost::json::value body = co_await long_json_body(app, request);
  const AnswerOfSession find = [&body](SessionEntry& e) { return json_response(answer(e.session, body)); };
  if (!body.is_array()) co_return co_await with_session_on_worker(app, entry, find);
  co_return co_await with_session_in_long_work(app, entry, find);
}

}  // namespace

void add_query_routes(net::Router& router, App& app) {
  router.add(net::Method::post, "/v1/sessions/{id}/queries",
             "A ray, shape cast, nearest, overlap or contact query at the present step, or an array of them",
             [&app](const Request& r) { return query(app, r); });
}

}  // namespace truestep
