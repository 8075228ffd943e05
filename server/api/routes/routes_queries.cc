// POST /v1/sessions/{id}/queries: spatial queries.
#include "engine/session/queries.h"
#include "server/api/requests.h"

namespace truestep {

using net::Request;
using net::Response;

namespace {

Task<Response> query(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const boost::json::value body = co_await long_json_body(app, request);
  co_return co_await with_session_on_worker(
      app, entry, [&body](SessionEntry& e) { return json_response(answer_query(e.session, body)); });
}

}  // namespace

void add_query_routes(net::Router& router, App& app) {
  router.add(net::Method::post, "/v1/sessions/{id}/queries",
             "Ray, nearest, overlap and contact queries at the present step",
             [&app](const Request& r) { return query(app, r); });
}

}  // namespace truestep
