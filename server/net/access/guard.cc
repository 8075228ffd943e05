#include "server/net/access/guard.h"

#include "server/net/access/address.h"
#include "server/net/access/digest.h"
#include "server/net/http/problem.h"

namespace truestep::net {
namespace {

// Host without port and brackets.
std::string_view host_name(std::string_view authority) {
  if (authority.starts_with('[')) return authority.substr(1, authority.find(']') - 1);
  return authority.substr(0, authority.find(':'));
}

}  // namespace

Guard::Guard(const Options& options)
    : hosts_(options.allowed_hosts), origins_(options.allowed_origins), keys_(options.api_key_file) {
  for (const std::string& h : hosts_) any_host_ = any_host_ || h == "*";
  for (const std::string& o : origins_) any_origin_ = any_origin_ || o == "*";
  for (const char* name : {"localhost", "127.0.0.1", "::1"}) hosts_.emplace_back(name);
  hosts_.push_back(options.host);
  // On all interfaces any literal address may be ours. Rebinding needs a name, so literals are safe.
  any_literal_ = options.host == "0.0.0.0" || options.host == "::";
}

bool Guard::host_allowed(std::string_view host) const {
  if (any_host_) return true;
  const std::string_view name = host_name(host);
  for (const std::string& h : hosts_) {
    if (iequals(h, name)) return true;
  }
  return any_literal_ && is_address(name);
}

bool Guard::origin_allowed(std::string_view origin, std::string_view host) const {
  if (any_origin_) return true;
  for (const std::string& o : origins_) {
    if (iequals(o, origin)) return true;
  }
  const size_t scheme = origin.find("://");
  if (scheme == std::string_view::npos) return false;
  if (origin.substr(0, scheme) != "http" && origin.substr(0, scheme) != "https") return false;
  return iequals(origin.substr(scheme + 3), host);
}

std::optional<Response> Guard::check_source(const Request& request) const {
  const std::string_view host = request.header("host");
  if (!(host.empty() && request.http10) && !host_allowed(host)) {
    return problem(request, "misdirected",
                   "the Host header names a host that this server does not serve; --allow-host adds names");
  }
  for (const Field& f : request.headers) {
    if (f.name.size() == 6 && iequals(f.name, "origin") && !origin_allowed(f.value, host)) {
      return problem(request, "forbidden", "requests from this origin are not allowed");
    }
  }
  return std::nullopt;
}

std::optional<Response> Guard::check_key(Request& request) {
  if (!keys_.asks()) return std::nullopt;
  std::string_view key;
  const std::string_view authorization = request.header("authorization");
  if (authorization.size() > 7 && iequals(authorization.substr(0, 7), "bearer "))
    key = trim(authorization.substr(7));
  if (key.empty() && request.header_has_token("upgrade", "websocket"))
    key = request.query_value("access_token").value_or("");
  if (key.empty()) return problem(request, "unauthorized", "no API key was sent");
  std::string digest = sha256_hex(key);
  const auto now = KeyThrottle::Clock::now();
  if (const int seconds = throttle_.wait(request.remote, digest, now); seconds > 0) {
    Response r = problem(request, "too_many_keys", "this address has sent too many wrong keys");
    return std::move(r.header("Retry-After", std::to_string(seconds)));
  }
  const auto ring = keys_.keys();
  const Caller* caller = ring->find(digest);
  if (!caller) {
    throttle_.failed(request.remote, now);
    return problem(request, "unauthorized", "the API key is not known");
  }
  throttle_.succeeded(request.remote, digest, now);
  request.caller = *caller;
  request.key_digest = std::move(digest);
  return std::nullopt;
}

}  // namespace truestep::net
