// Errors on the wire: RFC 9457 application/problem+json with the members type, title, status, code, detail,
// instance, trace_id and errors[{pointer, code, value, allowed, did_you_mean, unit, message}].
#pragma once
#include <boost/json/object.hpp>
#include <exception>
#include <span>
#include <string_view>

#include "engine/base/errors.h"
#include "server/net/http/message.h"

namespace truestep::net {

/// One row of the table of codes: what the HTTP description lists and clients switch on.
struct ProblemKind {
  std::string_view code;
  int status;
  std::string_view title;
};

/// Every code that a response can carry.
std::span<const ProblemKind> problem_kinds();
/// The row of a code; codes without a row count as "internal".
const ProblemKind& problem_kind(std::string_view code);

/// A problem response. `extra` members are added to the document (last_good_step, suggested_dt ...).
Response problem(const Request& request, std::string_view code, std::string_view detail,
                 std::span<const Issue> issues = {}, const boost::json::object& extra = {});
/// The response for an error thrown by a handler; an Instability adds system, quantity, index, step and
/// suggested dt.
Response problem(const Request& request, const Error& error);
/// The response for anything else that was thrown: 500 with the trace id only; the text goes to the log.
Response problem(const Request& request, const std::exception& error);

/// The errors[] member of a problem, also used for warnings.
boost::json::array issues_json(std::span<const Issue> issues);

}  // namespace truestep::net
