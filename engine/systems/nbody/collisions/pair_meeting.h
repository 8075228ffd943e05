// When two balls meet on a path that can be evaluated anywhere: Newton's method on their gap, kept within the
// bracket of what has been seen. A pair that parts again without touching is a near miss.
#pragma once
#include <cmath>
#include <optional>

#include "engine/math/vec3.h"

namespace truestep::nbody {

/// A pair at one moment: the distance of the surfaces (m), and the speed at which it falls (m/s).
struct Gap {
  double apart, closing;
  static Gap of(const Vec3& d, const Vec3& u, double reach) {
    const double r = norm(d);
    return {r - reach, r > 0 ? -dot(d, u) / r : 0};
  }
};

/// Time in [0, end] (s) at which `at(time)` is within `tolerance` (m) of touching and not parting (by more
/// than that until the end); the last call of `at` was for it. `guess`: about where. Empty: a near miss.
template <class At>
std::optional<double> time_of_meeting(At&& at, double guess, double end, double tolerance) {
  constexpr int kTrials = 60;
  double low = 0, high = end, t = guess;
  bool bracketed = false;
  for (int i = 0; i < kTrials; ++i) {
    const Gap g = at(t);
    if (std::abs(g.apart) <= tolerance)
      return -g.closing * end <= tolerance ? std::optional(t) : std::nullopt;
    if (g.apart < 0) {
      high = t, bracketed = true;
    } else {
      // Parting, and never seen inside; or the end is reached.
      if (!bracketed && (!(g.closing > 0) || t >= end)) return std::nullopt;
      low = t;
    }
    double next = t + g.apart / g.closing;
    const bool usable = g.closing > 0 && next > low && (next < high || (!bracketed && next > low));
    if (!usable) next = 0.5 * (low + high);
    next = std::min(next, end);
    if (next == t || (bracketed && high - low <= 1e-15 * end)) break;
    t = next;
  }
  if (!bracketed) return std::nullopt;
  const Gap g = at(high);
  return g.closing > 0 ? std::optional(high) : std::nullopt;
}

}  // namespace truestep::nbody
