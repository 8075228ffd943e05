// What links and springs share, whether between points or between points and bodies.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/core/coupling.h"

namespace truestep::attachment {

/// Links are swept until each is within this fraction of its length (or of a metre); rounding itself is
/// 1e-16.
inline constexpr double kLengthTolerance = 1e-13;
inline constexpr int kMostSweeps = 200;
/// Maximum number of Newton steps for the lengths and directions at the substep's end.
inline constexpr int kMostSolutions = 30;

/// Column of the mean forces in the last two substeps, N, when a side responds as a whole.
inline constexpr const char* kPairForce = "pair_force";
/// The column; null in states of the same scene under other methods, on which remedies are tried.
inline double* pair_forces(State& own) {
  const auto c = own.find(kPairForce);
  return c ? own.f64(*c).data() : nullptr;
}
/// The common part of a pair's last two forces, N: loads last, blows do not.
inline Vec3 lasting(const double* last, size_t pair) {
  const Vec3 f = load3(last, 2 * pair), before = load3(last, 2 * pair + 1);
  const double d = dot(f, before), ff = norm2(f);
  return d > 0 ? f * std::min(1.0, d / ff) : Vec3{};
}
/// The force of a link or spring of some length that was along r, as it will be midway between now and
/// `later`: along r alone it feeds whatever swings on it (a pendulum on a rigid link rose by 24 % in 10 s at
/// 60 Hz and loses 6 % so), along where both ends will be it brakes it (67 %).
inline Vec3 turned(const Vec3& force, const Vec3& r, const Vec3& later) {
  const Vec3 midway = r + later;
  return normalized(dot(midway, r) > 0 ? midway : r) * dot(force, normalized(r));
}
/// Makes room for the force of a new substep.
inline void pass_on(double* last, size_t pair, const Vec3& force) {
  store3(last, 2 * pair + 1, load3(last, 2 * pair));
  store3(last, 2 * pair, force);
}

/// Position and velocity of point j of b relative to point i of a.
template <class Real>
Vec3 separation(const PointsOf<Real>& a, size_t i, const PointsOf<Real>& b, size_t j) {
  return b.place(j) - a.place(i);
}
template <class Real>
Vec3 approach(const PointsOf<Real>& a, size_t i, const PointsOf<Real>& b, size_t j) {
  return b.velocity(j) - a.velocity(i);
}

/// Correction of r that restores |r| = L along the direction d of the substep's start (the root near zero of
/// a quadratic), or along r itself when the link has turned too far for that.
inline Vec3 length_correction(const Vec3& r, const Vec3& d, double rest) {
  if (rest == 0) return -r;
  const double rd = dot(r, d), dd = norm2(d), excess = norm2(r) - rest * rest;
  const double discriminant = rd * rd - dd * excess;
  if (rd > 0 && discriminant > 0) return d * (-excess / (rd + std::sqrt(discriminant)));
  return normalized(r) * rest - r;
}

}  // namespace truestep::attachment
