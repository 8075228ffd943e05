// A GET of /healthz: the container's health check needs no other program.
#pragma once
#include <string>

namespace truestep::net {

/// Whether the server at "http://host:port" answers 200 within 3 s.
bool is_healthy(const std::string& url);

}  // namespace truestep::net
