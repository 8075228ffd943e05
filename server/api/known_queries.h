// Query parameters that a route does not read are faults of the request: whoever writes one means something.
#pragma once
#include <functional>

#include "server/net/router.h"

namespace truestep {

/// A check of a row: Error "bad_request" with an issue for every parameter that the route's description does
/// not list (with what there is and the nearest name) or that comes twice. Empty for the viewer's files,
/// whose parameters the viewer reads.
std::function<void(const net::Request&)> query_check(const net::Route& route);

}  // namespace truestep
