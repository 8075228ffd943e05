#include "server/api/known_queries.h"

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/base/text/nearest_name.h"
#include "server/api/docs/openapi_tables.h"

namespace truestep {

namespace {

void check(const net::Request& request, const std::vector<std::string>& known) {
  std::string all;
  for (const std::string& name : known) (all += all.empty() ? "" : ", ") += name;
  std::vector<Issue> issues;
  for (size_t i = 0; i < request.query.size(); ++i) {
    const auto& name = request.query[i].name;
    const std::string pointer = "?" + std::string(name.substr(0, 64));
    const auto same = [&](const auto& other) { return other.name == name; };
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      issues.push_back({pointer, "unknown_parameter", "this request takes no such parameter", "",
                        all.empty() ? "no parameters" : all, nearest_name(name, known), ""});
    } else if (std::any_of(request.query.begin(), request.query.begin() + static_cast<ptrdiff_t>(i), same)) {
      issues.push_back({pointer, "duplicate", "this parameter may be given only once", "", "", "", ""});
    }
  }
  if (!issues.empty()) throw Error("bad_request", "the query has faults", std::move(issues));
}

}  // namespace

std::function<void(const net::Request&)> query_check(const net::Route& route) {
  if (!is_interface(route) || route.pattern == "/") return {};
  std::vector<std::string> known;
  for (const RouteParameter& p : route_parameters()) {
    if (p.method == route.method && p.pattern == route.pattern && p.in == "query") known.emplace_back(p.name);
  }
  return [known = std::move(known)](const net::Request& request) {
    if (!request.query.empty()) check(request, known);
  };
}

}  // namespace truestep
