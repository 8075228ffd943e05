// How contacts recover the penetration that their loads cause. A contact is a damped spring on the bodies'
// reduced mass m (soft_constraint.h), which yields by load / (m w^2): stacks would sink. The surfaces
// therefore have an offset that grows by a fraction of the depth in every step, until they almost touch under
// that load: an integral term in addition to the spring. It is the same for all points of a contact, because
// a tower whose contacts could learn a tilt would lean. A mode with the damping rate s is excited by offsets
// that adapt within T < 1 / (2 s), and a pile with redundant contacts never reaches zero depth everywhere: an
// offset is therefore frozen while the depth is small compared with it (docs/standing.md). In a heap of odd
// shapes offsets are strains between grains, which yield at a strain of some percent: they may be kept
// thinner than that.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

namespace truestep {

/// How the offsets of contacts adapt to their loads.
struct PenetrationOffsetRule {
  double learnt = 0;       ///< fraction of the depth that is added per step
  double per_load = 0;     ///< s; times the load, the largest offset
  double slack = 0;        ///< fraction of an offset: smaller depths leave the offset unchanged
  double most = HUGE_VAL;  ///< m: no offset grows beyond
};

/// Largest offset as a multiple of the spring's compression under the load, so that no offset outlives its
/// load.
inline constexpr double kMostOffset = 4;

/// For contacts of `hertz` solved at `rate` (1/s) in steps of h (s).
inline PenetrationOffsetRule penetration_offset_rule(double hertz, double rate, double h, double slack) {
  /// s, time constant of the recovery: the slowest mode of a pile of 100 rows has a damping rate of about
  /// 0.5/s.
  constexpr double kOffsetTime = 2;
  const double w = 2 * std::numbers::pi * hertz;
  return {h / (h + kOffsetTime), w > 0 ? kMostOffset * rate / (w * w) : 0, slack};
}

/// s; times the load, the offset that compensates the spring's whole compression.
inline double penetration_offset_at_rest(const PenetrationOffsetRule& rule) {
  return rule.per_load / kMostOffset;
}

/// Next offset (m) of a contact that was `depth` (m) deep under its load: the impulse of a substep times
/// 1/m_a + 1/m_b (m/s).
inline double next_penetration_offset(double offset, double depth, double load,
                                      const PenetrationOffsetRule& rule) {
  /// m; larger offsets adapt more slowly: modes that compress contacts this much are slow
  constexpr double kThickOffset = 4e-3;
  const double thickest = rule.per_load * load, gives_way = offset + depth;
  const double slower = gives_way > kThickOffset ? std::sqrt(kThickOffset / gives_way) : 1;
  const double next = std::abs(depth) < rule.slack * offset ? offset : offset + rule.learnt * slower * depth;
  return std::clamp(std::min(next, std::max(offset, rule.most)), 0.0, thickest);
}

}  // namespace truestep
