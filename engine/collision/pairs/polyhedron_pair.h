// Contact of two polyhedra (boxes, hulls, a triangle) by separating axes: face normals of both and cross
// products of those edge pairs that make a face of the difference set, found by whether their arcs on the
// Gauss map cross (Gregorius, "The separating axis test between convex polyhedra", GDC 2013).
#pragma once
#include "engine/collision/pairs/convex.h"
#include "engine/collision/pairs/manifold.h"

namespace truestep {

/// In a's frame, normal from a to b. Points at most `margin` (m) apart; out.count = 0 when there are none. a
/// may be a triangle, b may not.
void collide_polyhedra(const Convex& a, const Convex& b, const Transform& b_in_a, double margin,
                       Manifold& out);

}  // namespace truestep
