// Signed distance of a point to a solid in the solid's own frame, for any solid: what the contact of many
// points asks. Allocates nothing.
#pragma once
#include <optional>

#include "engine/geometry/solid.h"

namespace truestep {

struct PointDistance {
  double distance = 0;  ///< m, negative inside
  Vec3 normal;          ///< unit, outward
};

/// Nothing beyond `within` (m); of a mesh or height field the triangles that the point is in front of.
std::optional<PointDistance> point_distance(const Solid& solid, const Vec3& p, double within);

}  // namespace truestep
