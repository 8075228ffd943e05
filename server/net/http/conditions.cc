// Conditional and range requests, RFC 9110 sections 13.1.2, 13.1.5, 14.2 and 15.3.7.
#include <charconv>

#include "server/net/http/message.h"
#include "server/net/http/problem.h"

namespace truestep::net {
namespace {

// Does an entity-tag list match? Weak comparison: a W/ prefix does not matter.
bool matches(std::string_view list, std::string_view etag) {
  if (trim(list) == "*") return true;
  if (etag.starts_with("W/")) etag.remove_prefix(2);
  return list.find(etag) !=
         std::string_view::npos;  // a tag includes its quotes, so a substring is a whole tag
}

// Strong comparison: a weak tag never matches.
bool matches_strongly(std::string_view list, std::string_view etag) {
  if (trim(list) == "*") return true;
  if (etag.empty() || etag.starts_with("W/")) return false;
  for (size_t at = list.find(etag); at != std::string_view::npos; at = list.find(etag, at + 1)) {
    if (at < 2 || list.substr(at - 2, 2) != "W/") return true;
  }
  return false;
}

bool number(std::string_view s, uint64_t& v) {
  const auto r = std::from_chars(s.data(), s.data() + s.size(), v);
  return !s.empty() && r.ec == std::errc() && r.ptr == s.data() + s.size();
}

enum class RangeResult { ignore, satisfiable, unsatisfiable };

// One byte range: "bytes=a-b", "bytes=a-" or "bytes=-n".
RangeResult parse_range(std::string_view value, uint64_t size, uint64_t& first, uint64_t& last) {
  if (value.size() < 6 || !iequals(value.substr(0, 6), "bytes=")) return RangeResult::ignore;
  value = trim(value.substr(6));
  const size_t dash = value.find('-');
  if (dash == std::string_view::npos || value.find(',') != std::string_view::npos) return RangeResult::ignore;
  const std::string_view a = trim(value.substr(0, dash)), b = trim(value.substr(dash + 1));
  if (a.empty()) {
    uint64_t suffix = 0;
    if (!number(b, suffix)) return RangeResult::ignore;
    if (suffix == 0 || size == 0) return RangeResult::unsatisfiable;
    first = suffix >= size ? 0 : size - suffix;
    last = size - 1;
    return RangeResult::satisfiable;
  }
  if (!number(a, first)) return RangeResult::ignore;
  last = size - 1;
  if (!b.empty()) {
    uint64_t end = 0;
    if (!number(b, end) || end < first) return RangeResult::ignore;
    if (end < last) last = end;
  }
  return first < size ? RangeResult::satisfiable : RangeResult::unsatisfiable;
}

}  // namespace

bool may_change(const Request& request) {
  if (request.method == Method::get || request.method == Method::head || request.method == Method::options)
    return true;
  return !request.has_header("if-match") || trim(request.header("if-match")) == "*";
}

void apply_conditions(const Request& request, Response& response) {
  if (response.status != 200) return;
  if (request.method != Method::get && request.method != Method::head) return;
  if (request.has_header("if-match") && !matches_strongly(request.header("if-match"), response.etag)) {
    response = problem(request, "precondition_failed", "If-Match names another state of this resource");
    return;
  }
  if (response.etag.empty()) return;
  const std::string_view none_match = request.header("if-none-match");
  if (!none_match.empty() && matches(none_match, response.etag)) {
    response.status = 304;
    response.body = std::string();
    response.content_type.clear();
    return;
  }
  response.header("Accept-Ranges", "bytes");
  const std::string_view range = request.header("range");
  if (range.empty() || request.method != Method::get) return;
  const std::string_view if_range = request.header("if-range");
  // A date in If-Range never matches: no Last-Modified is sent. A weak tag must not match either.
  if (!if_range.empty() && (if_range != response.etag || if_range.starts_with("W/"))) return;
  const uint64_t size = response.body_size();
  uint64_t first = 0, last = 0;
  switch (parse_range(range, size, first, last)) {
    case RangeResult::ignore:
      return;
    case RangeResult::unsatisfiable:
      response.status = 416;
      response.header("Content-Range", "bytes */" + std::to_string(size));
      response.body = std::string();
      response.content_type.clear();
      return;
    case RangeResult::satisfiable:
      response.status = 206;
      response.header("Content-Range", "bytes " + std::to_string(first) + "-" + std::to_string(last) + "/" +
                                           std::to_string(size));
      response.offset = first;
      response.length = last - first + 1;
  }
}

}  // namespace truestep::net
