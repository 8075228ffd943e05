// Edges of bodies against lines between points. Both are looked at where they stand at the substep's start
// and end; the direction is the common perpendicular, on the side on which the points were at the start (of
// convex edges: outside). A pair that passes and leaves the other's ends within one substep is not found;
// corners, balls and points against faces hold those.
#pragma once
#include <optional>

#include "engine/math/vec3.h"

namespace truestep::contact {

/// Ends of a line at the start and at the end, m.
struct MovingEdge {
  Vec3 from0, to0, from1, to1;
};

struct EdgeMeeting {
  double along = 0;  ///< share of the way along the points' line
  Vec3 n, place;     ///< unit, from the body to the points; m, on the body's edge, at the end
  double s = 0;      ///< fraction of the substep at which they touch; 1: they come near only
};

/// Nothing where the nearest places are ends (those are points and corners), further apart than `within` (m),
/// or the points are behind the edge. `outward`: zero where all directions are.
std::optional<EdgeMeeting> edges_meet(const MovingEdge& points, const MovingEdge& body, const Vec3& outward,
                                      double reach, double within);

}  // namespace truestep::contact
