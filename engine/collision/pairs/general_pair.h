// Contact of any two convex solids, for pairs without a better method (cylinders, large hulls): distance or
// depth of the cores, then points from the touching faces or lines.
#pragma once
#include "engine/collision/pairs/convex.h"
#include "engine/collision/pairs/manifold.h"

namespace truestep {

/// In a's frame, normal from a to b, points at most `margin` (m) apart; out.count = 0: none. b must not be a
/// triangle.
void collide_general(const Convex& a, const Convex& b, const Transform& b_in_a, double margin, Manifold& out);

}  // namespace truestep
