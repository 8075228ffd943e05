// Query parameters that a route does not read are errors of the request: the client meant something by them.
#pragma once
#include <functional>

#include "server/net/http/router.h"

namespace truestep {

/// A check for a row: Error "bad_request" with an issue for every parameter that is repeated or not in the
/// route's description (with what is allowed and the nearest name). Empty for the viewer's files, whose
/// parameters the viewer reads.
std::function<void(const net::Request&)> query_check(const net::Route& route);

}  // namespace truestep
