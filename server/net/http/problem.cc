#include "server/net/http/problem.h"

#include <boost/json.hpp>

#include "engine/base/interrupt.h"
#include "engine/base/log.h"
#include "engine/base/text/utf8.h"
#include "engine/scene/json/json_write.h"

namespace truestep::net {
namespace {

namespace json = boost::json;

constexpr ProblemKind kKinds[] = {
    {"bad_request", 400, "The request is malformed"},
    {"bad_json", 400, "The body is not acceptable JSON"},
    {"unauthorized", 401, "An API key is required"},
    {"forbidden", 403, "Not allowed"},
    {"not_found", 404, "Nothing is here"},
    {"unknown_session", 404, "No such session"},
    {"unknown_operation", 404, "No such operation"},
    {"method_not_allowed", 405, "This method is not allowed here"},
    {"not_acceptable", 406, "None of the accepted media types is available"},
    {"request_timeout", 408, "The request took too long to arrive"},
    {"step_conflict", 409, "The session is at another step"},
    {"instability", 409, "The simulation became unstable"},
    {"creating", 409, "The session is still being made"},
    {"interrupted", 409, "Another request cut this one short"},
    {"conflict", 409, "The resource is in another state"},
    {"session_damaged", 409, "What is saved of the session cannot be used"},
    {"session_expired", 410, "The session has expired"},
    {"precondition_failed", 412, "A precondition does not hold"},
    {"too_large", 413, "The request is too large"},
    {"unsupported_media", 415, "This media type is not understood"},
    {"expectation_failed", 417, "The expectation cannot be met"},
    {"misdirected", 421, "This host name is not served here"},
    {"scene_invalid", 422, "The scene is not valid"},
    {"invalid", 422, "The request is not valid"},
    {"bad_command", 422, "The command makes no sense here"},
    {"bad_query", 422, "The query makes no sense here"},
    {"unknown_system", 422, "No such system"},
    {"bad_pointer", 422, "The scene has no such place"},
    {"accuracy_unreachable", 422, "No method is this accurate on this scene"},
    {"study_failed", 422, "The study cannot be done"},
    {"bad_snapshot", 422, "The snapshot cannot be used"},
    {"bad_bundle", 422, "The bundle cannot be used"},
    {"idempotency_key_reused", 422, "The idempotency key was used for another request"},
    {"upgrade_required", 426, "A WebSocket handshake is required"},
    {"too_many_keys", 429, "Too many wrong keys"},
    {"quota_exceeded", 429, "A limit is reached"},
    {"head_too_large", 431, "The request's head is too large"},
    {"internal", 500, "Something went wrong inside the service"},
    {"not_implemented", 501, "Not implemented"},
    {"starting", 503, "The service is still starting"},
    {"draining", 503, "The service is shutting down"},
    {"overloaded", 503, "The service is at its limit"},
    {"render_unavailable", 503, "Pictures cannot be drawn here"},
    {"recording_io", 503, "The recording failed"},
    {"folder_io", 503, "The data folder cannot be used"},
    {"disk_full", 507, "The disk is full"},
};

json::string_view view(std::string_view s) {
  return {s.data(), s.size()};
}

// Makes text of unknown origin valid for JSON.
json::string clean(std::string_view s) {
  return valid_utf8(s) ? json::string(view(s)) : json::string("(not valid UTF-8)");
}

// Values are JSON texts when they come from a parsed document, plain text otherwise.
json::value value_json(const std::string& text) {
  json::error_code ec;
  json::value v = json::parse(text, ec);
  return ec ? json::value(clean(text)) : v;
}

}  // namespace

std::span<const ProblemKind> problem_kinds() {
  return kKinds;
}

const ProblemKind& problem_kind(std::string_view code) {
  const ProblemKind* internal = kKinds;
  for (const ProblemKind& k : kKinds) {
    if (k.code == code) return k;
    if (k.code == "internal") internal = &k;
  }
  return *internal;
}

json::array issues_json(std::span<const Issue> issues) {
  json::array out;
  out.reserve(issues.size());
  for (const Issue& i : issues) {
    json::object o;
    o["pointer"] = clean(i.pointer);
    o["code"] = i.code;
    if (!i.message.empty()) o["message"] = clean(i.message);
    if (!i.value.empty()) o["value"] = value_json(i.value);
    if (!i.allowed.empty()) o["allowed"] = clean(i.allowed);
    if (!i.did_you_mean.empty()) o["did_you_mean"] = clean(i.did_you_mean);
    if (!i.unit.empty()) o["unit"] = i.unit;
    out.push_back(std::move(o));
  }
  return out;
}

Response problem(const Request& request, std::string_view code, std::string_view detail,
                 std::span<const Issue> issues, const json::object& extra) {
  const ProblemKind& kind = problem_kind(code);
  json::object o;
  o["type"] = "urn:truestep:problem:" + std::string(kind.code);
  o["title"] = view(kind.title);
  o["status"] = kind.status;
  o["code"] = view(kind.code);
  if (!detail.empty() && kind.code != "internal") o["detail"] = clean(detail);
  o["instance"] = clean(request.raw_path);
  o["trace_id"] = request.trace_id();
  if (!issues.empty()) o["errors"] = issues_json(issues);
  for (const auto& member : extra) o[member.key()] = member.value();
  Response r = Response::text(write_json(o), "application/problem+json", kind.status);
  r.header("Cache-Control", "no-store");
  // The guard tells clients that guess keys how long to wait.
  if (kind.status == 503 || (kind.status == 429 && kind.code != "too_many_keys"))
    r.header("Retry-After", "1");
  if (kind.status == 401) r.header("WWW-Authenticate", "Bearer realm=\"truestep\"");
  if (kind.status == 426)
    r.header("Upgrade", "websocket").header("Connection", "Upgrade").header("Sec-WebSocket-Version", "13");
  return r;
}

Response problem(const Request& request, const Error& error) {
  // Work for a request is interrupted only when the service ends.
  if (dynamic_cast<const Interrupted*>(&error)) return problem(request, "draining", "try again later");
  if (problem_kind(error.code()).code == "internal")
    return problem(request, static_cast<const std::exception&>(error));
  json::object extra;
  if (const auto* unstable = dynamic_cast<const Instability*>(&error)) {
    extra["system"] = clean(unstable->system);
    extra["quantity"] = clean(unstable->quantity);
    extra["index"] = unstable->index;
    extra["step"] = unstable->step;
    extra["last_good_step"] = unstable->step - 1;
    if (unstable->suggested_dt > 0) extra["suggested_dt"] = unstable->suggested_dt;
  }
  return problem(request, error.code(), error.what(), error.issues(), extra);
}

Response problem(const Request& request, const std::exception& error) {
  log_error("internal error, trace {}: {} {}: {}", request.trace_id(), request.method_text, request.raw_path,
            error.what());
  return problem(request, "internal", {});
}

}  // namespace truestep::net
