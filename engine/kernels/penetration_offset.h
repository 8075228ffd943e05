// How contacts take back what loads press in. A contact is a damped spring of the bodies' reduced mass m
// (soft_constraint.h), which gives way by load / (m w^2): stacks would sink. So the surfaces have an offset
// between them that grows by a share of the depth in every step, until under that load they almost touch: an
// integral term beside the spring. It is the same for all points of a contact, because a tower whose contacts
// learnt to tilt would lean. A mode that is damped at the rate s is fed by offsets that learn in T < 1 / (2
// s), and a pile with more contacts than it needs never finds depths of zero: so offsets rest as soon as the
// depth is small beside them (docs/standing.md).
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

namespace truestep {

/// How the offsets of contacts follow their loads.
struct PenetrationOffsetRule {
  double learnt = 0;    ///< share of a depth that is added in a step
  double per_load = 0;  ///< s, times the load: the thickest offset
  double slack = 0;     ///< share of an offset: depths below it leave the offset as it is
};

/// An offset tends to at most that many times what the spring gives way under its load, so that none outlasts
/// it.
inline constexpr double kMostOffset = 4;

/// For contacts of `hertz` solved at `rate` (1/s) in steps of h (s).
inline PenetrationOffsetRule penetration_offset_rule(double hertz, double rate, double h, double slack) {
  /// s in which a contact takes back how far its load presses it in: the slowest mode of a pile of 100 rows
  /// is damped at some 0.5/s.
  constexpr double kOffsetTime = 2;
  const double w = 2 * std::numbers::pi * hertz;
  return {h / (h + kOffsetTime), w > 0 ? kMostOffset * rate / (w * w) : 0, slack};
}

/// s, times the load: the offset that takes back all that the spring gives way.
inline double penetration_offset_at_rest(const PenetrationOffsetRule& rule) {
  return rule.per_load / kMostOffset;
}

/// The offset (m) of a contact that was `depth` (m) deep under its load: the impulse of a substep times
/// 1/m_a + 1/m_b (m/s).
inline double next_penetration_offset(double offset, double depth, double load,
                                      const PenetrationOffsetRule& rule) {
  /// m; thicker ones grow the slower: what presses that much sways slowly.
  constexpr double kThickOffset = 4e-3;
  const double thickest = rule.per_load * load, gives_way = offset + depth;
  const double slower = gives_way > kThickOffset ? std::sqrt(kThickOffset / gives_way) : 1;
  const double next = std::abs(depth) < rule.slack * offset ? offset : offset + rule.learnt * slower * depth;
  return std::clamp(next, 0.0, thickest);
}

}  // namespace truestep
