// Contact of two boxes: separating axes (3 + 3 faces, 9 pairs of edges), then the touching faces clipped to
// up to four points, or the nearest points of two edges.
#pragma once
#include "engine/collision/pairs/manifold.h"
#include "engine/geometry/transform.h"

namespace truestep {

/// Boxes of half extents a and b (m), all in a's frame, normal from a to b. Points at most `margin` (m >= 0)
/// apart; out.count = 0 when there are none. The depth is the smallest translation that separates the boxes,
/// to a thousandth of their smallest half extent (faces are preferred to edges by that much).
void collide_boxes(const Vec3& a, const Vec3& b, const Transform& b_in_a, double margin, Manifold& out);

}  // namespace truestep
