// Common parts of collision tests: random solids and positions, and an independent measure of the separation
// of two convex solids, the largest over directions n of
//   s(n) = min_b n . x - max_a n . x     (the furthest points of a and b implemented again, in long double),
// found by sampling the sphere and climbing. The result is attained by some direction, so it never exceeds
// the true separation.
#pragma once
#include <vector>

#include "engine/base/random.h"
#include "engine/collision/pairs/convex.h"
#include "engine/geometry/solid.h"

namespace truestep::collision_rig {

using Real = long double;
using VecL = Vec3T<Real>;

struct Placed {
  Solid solid;
  Transform at;
};

/// Uniform rotation and numbers, by counter.
Quat random_quat(uint64_t stream, uint64_t i);
Vec3 random_unit(uint64_t stream, uint64_t i);
Transform random_transform(uint64_t stream, uint64_t i, double reach);
/// Sphere, capsule, box, cylinder, hull, needle, plate, boulder: number k of 8, `size` m large.
Solid sample_solid(int k, uint64_t seed, double size);
inline constexpr int kSolids = 8;
/// A quarter-turn rotation (24 of them): parallel and square edges.
Quat quarter_turns(uint64_t i);

/// Furthest reach of a placed convex solid along n.
Real reach(const Placed& p, const VecL& n);
/// s(n) for unit n.
Real separation_along(const Placed& a, const Placed& b, const VecL& n);
/// Largest s(n) found.
Real separation(const Placed& a, const Placed& b);
/// Signed distance (m, <= 0 inside; outside a lower bound) of a world point to a convex solid.
double outside(const Placed& p, const Vec3& x);

}  // namespace truestep::collision_rig
