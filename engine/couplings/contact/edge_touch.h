// Edges of bodies against lines between points. Both are tested in their positions at the substep's start and
// end; the direction is the common perpendicular, on the side where the points were at the start (for convex
// edges: outside). A pair that passes and moves beyond the other's ends within one substep is not found;
// corners, balls and points against faces catch those.
#pragma once
#include <optional>

#include "engine/math/vec3.h"

namespace truestep::contact {

/// Ends of a line at the start and at the end, m.
struct MovingEdge {
  Vec3 from0, to0, from1, to1;
};

struct EdgeMeeting {
  double along = 0;  ///< fraction along the points' line
  Vec3 n, place;     ///< unit, from the body to the points; m, on the body's edge, at the end
  double s = 0;      ///< fraction of the substep at which they touch; 1: they only come near
};

/// Empty if the closest points are ends (handled as points and corners), farther apart than `within` (m), or
/// if the points are behind the edge. `outward`: zero if every direction is outward.
std::optional<EdgeMeeting> edges_meet(const MovingEdge& points, const MovingEdge& body, const Vec3& outward,
                                      double reach, double within);

}  // namespace truestep::contact
