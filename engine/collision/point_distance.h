// Signed distance of a point to a solid in the solid's own frame, for any solid: used by contacts of many
// points. Does not allocate.
#pragma once
#include <optional>

#include "engine/geometry/solid.h"

namespace truestep {

struct PointDistance {
  double distance = 0;  ///< m, negative inside
  Vec3 normal;          ///< unit, outward
};

/// Empty beyond `within` (m); for a mesh or height field, only triangles that the point is in front of count.
std::optional<PointDistance> point_distance(const Solid& solid, const Vec3& p, double within);

}  // namespace truestep
