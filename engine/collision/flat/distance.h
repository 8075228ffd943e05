// Distance, casts and time of impact of outlines in the plane. Distances by the algorithm of Gilbert, Johnson
// and Keerthi (1988) on the sharp polygons, whose rounding is taken off afterwards; impacts by conservative
// advancement (Mirtich 1996): a pair never moves further than its distance allows.
#pragma once
#include <optional>

#include "engine/collision/flat/outline.h"

namespace truestep::flat {

/// Nearest points of the sharp polygons, and a corner of each that is or is next to them.
struct CoreDistance {
  double distance = 0;  ///< 0 when they overlap
  Vec2 on_a, on_b;
  uint32_t corner_a = 0, corner_b = 0;
};
/// Both in the same frame.
CoreDistance core_distance(const Outline& a, const Outline& b);

struct Distance {
  double distance = 0;  ///< m between the surfaces; 0 when they overlap
  Vec2 on_a, on_b;      ///< nearest points of the surfaces, in the frame of a
  Vec2 normal;          ///< unit, from a to b; zero when the sharp polygons overlap
};
/// a against b, which is at pose b_in_a seen from a. Sides of links do not matter.
Distance distance(const Outline& a, const Outline& b, const Pose& b_in_a);
bool overlap(const Outline& a, const Outline& b, const Pose& b_in_a);

struct RayHit {
  double fraction = 0;  ///< of the ray
  Vec2 normal;          ///< unit, of the surface that was hit
};
/// First place where origin + fraction * ray (0 to 1) enters the outline, all in its own frame. Empty when
/// the origin is inside. A link is hit only from its solid sides.
std::optional<RayHit> ray_cast(const Outline& s, Vec2 origin, Vec2 ray);

/// A motion from one pose to another: `pivot` (own frame) moves along a straight line, the angle at a
/// constant rate.
struct Sweep {
  Pose from;
  double angle = 0;  ///< rad, from `from` to the end
  Vec2 shift;        ///< m, of the origin
  Pose at(double fraction) const;
};
/// A box, flat in z, that holds the outline during the whole motion; `reach`: of the outline from the pivot
/// (m).
Box swept_box(const Outline& s, const Sweep& sweep, double reach);
struct Impact {
  double fraction = 0;
  Vec2 normal;  ///< from a to b, in the world
};
/// Largest fraction of both motions after which the surfaces are still `gap` (m) apart; empty when they never
/// come that close. If they are closer from the start, the fraction is 0. Links count as two-sided.
std::optional<Impact> time_of_impact(const Outline& a, const Sweep& move_a, const Outline& b,
                                     const Sweep& move_b, double gap);

}  // namespace truestep::flat
