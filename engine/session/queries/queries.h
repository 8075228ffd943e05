// Spatial queries on a state: what a ray hits, what is nearest, what a box or ball overlaps, what touches.
// Bodies are queried by their exact solids; other systems by what is drawn of them: their visuals, their
// obstacles, and points as balls of their drawn radius. Lines and sheets between points are not included.
#pragma once
#include <boost/json.hpp>
#include <functional>
#include <span>
#include <string_view>

#include "engine/core/def/def.h"
#include "engine/session/queries/surroundings.h"

namespace truestep {

struct QueryType {
  std::string_view name;
  const DefTable* table;
};
std::span<const QueryType> query_types();

/// The answer to a query: "hits" (ray, shape_cast, nearest: sorted by distance in m, each with system, index,
/// point and outward normal), "items" (overlap) or "contacts". Shapes that no row carries (obstacles) have no
/// index.
using PreparedQuery = std::function<boost::json::object(Surroundings&)>;
/// Reads {"type": ..., parameters} for sessions of this world. Error "bad_query" with every fault and its
/// pointer.
PreparedQuery read_query(const World& world, const boost::json::value& query);

/// The answer to a query in the session's present state, or to an array of them, in order. Errors as of
/// read_query.
boost::json::value answer_queries(const Session& session, const boost::json::value& queries);

}  // namespace truestep
