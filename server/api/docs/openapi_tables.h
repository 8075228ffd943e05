// What the HTTP description says of each route beyond its pattern and sentence: what it reads and what it
// answers on success. Problems are the same everywhere (net/http/problem.h).
#pragma once
#include <boost/json/object.hpp>
#include <span>
#include <string_view>

#include "server/net/http/router.h"

namespace truestep {

inline constexpr std::string_view kViewerFile = "A file of the viewer";
/// The viewer's files are not part of the interface.
bool is_interface(const net::Route& route);

/// One answer of a route. Rows with the same status are its media types; `schema` names one of
/// `answer_schemas`, or is empty for a text or a file.
struct RouteAnswer {
  net::Method method;
  std::string_view pattern;
  int status;
  std::string_view media, schema, description;
};
/// Answers of a route; empty for one that is not listed.
std::span<const RouteAnswer> answers_of(const net::Route& route);

/// The schemas that answers refer to, and "Problem".
boost::json::object answer_schemas();

/// A query parameter of GET, or a header of any method.
struct RouteParameter {
  net::Method method;
  std::string_view pattern, in, name;
  std::string_view schema;  ///< JSON
  std::string_view description;
};
std::span<const RouteParameter> route_parameters();

/// {"$ref": a schema of the document}.
boost::json::object schema_reference(std::string_view name);

/// JSON schema of a {name} in a pattern.
std::string_view path_parameter_schema(std::string_view pattern, std::string_view name);

/// The body that a route takes: media types with their schemas; empty when there is none.
boost::json::object body_of(const net::Route& route);
/// Whether the route needs a body that is not empty.
bool body_is_required(const net::Route& route);
/// Schemas used only by bodies.
boost::json::object body_schemas();

}  // namespace truestep
