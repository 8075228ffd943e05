// The HTTP description: OpenAPI 3.1 and a readable page, both generated from the table of routes.
#pragma once
#include <boost/json.hpp>

#include "server/net/router.h"

namespace truestep {

boost::json::object openapi_document(const net::Router& router);
/// Adds /openapi.json and /docs; call last, so that they describe everything.
void add_description_routes(net::Router& router);

}  // namespace truestep
