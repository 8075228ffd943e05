// Threshold above which approaches of rigid bodies count as impacts, in the plane and in space.
#pragma once
#include <cstdio>
#include <limits>
#include <string>

namespace truestep {

/// m/s; slower approaches do not bounce unless the scene sets its own limit. A hop that starts at v lasts 2 v
/// / g: one shorter than a step would begin and end unseen, and bodies would hop for ever.
/// Without gravity there is no such hop, and everything bounces. `gravity` in m/s^2, `dt` in s.
constexpr double slowest_bounce(double gravity, double dt) {
  return 0.5 * gravity * dt;
}

/// The same limit (m/s) in words, for a plan.
inline std::string says_slowest_bounce(double speed) {
  if (!(speed > 0)) return "impacts of any speed bounce";
  char text[80];
  std::snprintf(text, sizeof text, "impacts slower than %.3g m/s do not bounce", speed);
  return text;
}

/// Rounding error of a body's position as a fraction of its motion in a substep: displacements are sums over
/// the up to 64 substeps of a step, with a few roundings in each.
template <class T>
inline constexpr T impact_rounding = 256 * std::numeric_limits<T>::epsilon();

}  // namespace truestep
