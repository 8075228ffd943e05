// How far the energy of an explicit method swings near the limit of its step.
//
// With r = omega h / 2 symplectic Euler and leapfrog keep (w x)^2 + v^2 + 2 r (w x) v, velocity Verlet keeps
// (1 - r^2) (w x)^2 + v^2: the energy changes by at most (1 + r) / (1 - r). Verlet's position form, whose
// velocities are differences, reaches 1.2 times that; other methods swing less at the same share r of their
// limits (energy_swing_test.cc). Twice that is allowed.
#pragma once
#include <algorithm>

#include "engine/core/energy.h"

namespace truestep {

/// Energy::swing of an explicit method whose step is this share of its limit. At the limit and beyond, which
/// may be an estimate from below, it is not known: kSwingNearLimit.
inline double swing_at(double share) {
  if (!(share < 1)) return Energy::kSwingNearLimit;
  return std::clamp(2 * (1 + share) / (1 - share), Energy::kSwing, Energy::kSwingNearLimit);
}

}  // namespace truestep
