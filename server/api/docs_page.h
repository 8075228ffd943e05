// GET /docs: every request with what it reads, its body, its answers and an example; the stream's protocol;
// the schemas; the codes of problems. Made of the tables that the machine-readable description is made of.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "server/net/router.h"

namespace truestep {

/// A command of a shell that has $base and what the commands before it have set. They run in the order given.
struct RouteExample {
  net::Method method;
  std::string_view pattern;
  std::string_view command;
};
std::span<const RouteExample> route_examples();

/// Of a stream in JavaScript, given `base` and `id`.
std::string_view stream_example();

std::string docs_page(const net::Router& router);

}  // namespace truestep
