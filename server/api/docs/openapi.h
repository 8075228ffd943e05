// The HTTP description: OpenAPI 3.1 and a readable page, both generated from the table of routes.
#pragma once
#include <boost/json.hpp>

#include "server/net/http/router.h"

namespace truestep {

/// What differs from server to server.
struct ServiceDescription {
  bool keys = false;       ///< API keys are required
  size_t max_message = 0;  ///< largest message from a stream's client, in bytes
};

boost::json::object openapi_document(const net::Router& router, const ServiceDescription& service);
/// Adds /openapi.json and /docs; call last, so that they describe every route.
void add_description_routes(net::Router& router, const ServiceDescription& service);

}  // namespace truestep
