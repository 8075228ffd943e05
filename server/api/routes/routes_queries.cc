// POST /v1/sessions/{id}/queries: spatial queries.
#include "engine/base/error_place.h"
#include "engine/session/queries.h"
#include "server/api/requests.h"

namespace truestep {

using net::Request;
using net::Response;

namespace {

namespace json = boost::json;

// Of one query, or of an array of them.
json::value answer_queries(const Session& session, const json::value& body) {
  if (!body.is_array()) return answer_query(session, body);
  constexpr size_t kMostQueries = 10'000;
  if (body.as_array().size() > kMostQueries) throw Error("bad_query", "at most 10000 queries at once");
  json::array out;
  for (const json::value& query : body.as_array()) {
    try {
      out.push_back(answer_query(session, query));
    } catch (const Error& e) {
      throw placed_below(e, '/' + std::to_string(out.size()));
    }
  }
  return out;
}

Task<Response> query(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const boost::json::value body = co_await long_json_body(app, request);
  co_return co_await with_session_on_worker(
      app, entry, [&body](SessionEntry& e) { return json_response(answer_queries(e.session, body)); });
}

}  // namespace

void add_query_routes(net::Router& router, App& app) {
  router.add(net::Method::post, "/v1/sessions/{id}/queries",
             "A ray, nearest, overlap or contact query at the present step, or an array of them",
             [&app](const Request& r) { return query(app, r); });
}

}  // namespace truestep
