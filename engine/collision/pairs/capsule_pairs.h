// A capsule against a polyhedron (box, hull or triangle): distance of its axis, or separating axes when the
// axis penetrates; two points when it lies on a face.
#pragma once
#include "engine/collision/pairs/convex.h"
#include "engine/collision/pairs/manifold.h"

namespace truestep {

/// In a's frame, normal from a to the capsule b, points at most `margin` (m) apart; out.count = 0: none.
void collide_capsule(const Convex& a, const Convex& b, const Transform& b_in_a, double margin, Manifold& out);

}  // namespace truestep
