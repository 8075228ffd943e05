// A half space against every convex solid: the corners, rim points or ball that reach below its surface.
#pragma once
#include "engine/collision/pairs/convex.h"
#include "engine/collision/pairs/manifold.h"

namespace truestep {

/// Half space below the plane through the origin with the given unit normal, which is also the manifold's. b
/// relative to the plane's frame; points at most `margin` (m) above it; out.count = 0: none.
void collide_plane(const Vec3& normal, const Convex& b, const Transform& b_in_a, double margin,
                   Manifold& out);

}  // namespace truestep
