// Colliders that can do no work on points: all are at rest, and no point begins in one, out of which it would
// be lifted.
#pragma once
#include <algorithm>
#include <span>

#include "engine/collision/points/collider_set.h"

namespace truestep {

/// Whether the colliders can do no work on points of this radius (m) that begin at x (m).
inline bool idle(const ColliderSet& colliders, std::span<const Vec3> x, double radius) {
  constexpr double kTouching = 1e-6;
  if (!std::ranges::all_of(colliders.colliders(), [](const Collider& c) { return c.motion.at_rest(); }))
    return false;
  return std::ranges::none_of(
      x, [&](const Vec3& p) { return colliders.clearance(p, 0) < radius * (1 - kTouching) - kContactSlop; });
}

}  // namespace truestep
