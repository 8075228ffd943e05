// GET /docs: every request with its parameters, body, answers and an example; the protocol of the stream; the
// schemas; the problem codes. Generated from the same tables as the machine-readable description.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "server/net/http/router.h"

namespace truestep {

/// A shell command that uses $base and variables set by the commands before it. They run in the order given.
struct RouteExample {
  net::Method method;
  std::string_view pattern;
  std::string_view command;
};
std::span<const RouteExample> route_examples();

/// A stream client in JavaScript, given `base` and `id`.
std::string_view stream_example();

std::string docs_page(const net::Router& router);

}  // namespace truestep
