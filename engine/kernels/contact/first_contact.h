// First contact of a point that moves along a segment with a convex solid, and first exit from one. With f(s)
// = d(p(s)) - target convex in s, Newton's iteration from the start (f > 0) stays left of the first root and
// converges to it; from the end of a segment that leaves the solid it stays right of the only root. Hence
// nothing is missed, however thin the solid or fast the point. A segment that only grazes the surface, to
// rounding, may count as a miss; it ends outside all the same.
#pragma once
#include <optional>

#include "engine/geometry/shape_distance.h"

namespace truestep {

inline constexpr int kContactIterations = 60;

/// First s in [0, 1] where the segment p0 -> p0 + dp comes within `target` (m) of the solid whose distance
/// function is `distance(p)`; empty when it does not. A start already within `target` is a hit at 0.
template <class T, class Distance>
std::optional<T> first_entry(const Distance& distance, const Vec3T<T>& p0, const Vec3T<T>& dp, T target) {
  T s = 0;
  for (int i = 0; i < kContactIterations; ++i) {
    const SurfaceDistance<T> at = distance(p0 + dp * s);
    const T f = at.d - target, slope = dot(at.n, dp);
    if (f <= 0) return s;
    if (slope >= 0) return std::nullopt;
    const T next = s - f / slope;
    if (next > 1) return std::nullopt;
    if (next == s) return s;
    s = next;
  }
  return s;
}

/// First s in [0, 1] where the segment comes within `target` of the wall from inside (d = -target); empty
/// when it ends farther inside than that. A start already there is a hit at 0.
template <class T, class Distance>
std::optional<T> first_exit(const Distance& distance, const Vec3T<T>& p0, const Vec3T<T>& dp, T target) {
  if (distance(p0 + dp).d + target <= 0) return std::nullopt;
  if (distance(p0).d + target >= 0) return T(0);
  T s = 1;
  for (int i = 0; i < kContactIterations; ++i) {
    const SurfaceDistance<T> at = distance(p0 + dp * s);
    const T f = at.d + target, slope = dot(at.n, dp);
    if (f <= 0 || slope <= 0) return s;
    const T next = s - f / slope;
    if (next <= 0) return T(0);
    if (next == s) return s;
    s = next;
  }
  return s;
}

}  // namespace truestep
