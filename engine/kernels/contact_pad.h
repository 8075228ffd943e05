// How contacts take back what loads press in. A contact is a damped spring of the bodies' reduced mass m
// (soft_constraint.h), which gives way by load / (m w^2): stacks would sink. So the surfaces have a pad
// between them that grows by a share of the depth in every step, until under that load they almost touch: an
// integral term beside the spring. It is the same for all points of a contact, because a tower whose contacts
// learnt to tilt would lean. A mode that is damped at the rate s is fed by pads that learn in T < 1 / (2 s),
// and a pile with more contacts than it needs never finds depths of zero: so pads rest as soon as the depth
// is small beside them (docs/standing.md).
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

namespace truestep {

/// How the pads of contacts follow their loads.
struct ContactPadding {
  double learnt = 0;    ///< share of a depth that is added in a step
  double per_load = 0;  ///< s, times the load: the thickest pad
  double slack = 0;     ///< share of a pad: depths below it leave the pad as it is
};

/// A pad tends to at most that many times what the spring gives way under its load, so that none outlasts it.
inline constexpr double kMostPad = 4;

/// For contacts of `hertz` solved at `rate` (1/s) in steps of h (s).
inline ContactPadding contact_padding(double hertz, double rate, double h, double slack) {
  /// s in which a contact takes back how far its load presses it in: the slowest mode of a pile of 100 rows
  /// is damped at some 0.5/s.
  constexpr double kPadTime = 2;
  const double w = 2 * std::numbers::pi * hertz;
  return {h / (h + kPadTime), w > 0 ? kMostPad * rate / (w * w) : 0, slack};
}

/// s, times the load: the pad that takes back all that the spring gives way.
inline double pad_at_rest(const ContactPadding& padding) {
  return padding.per_load / kMostPad;
}

/// The pad (m) of a contact that was `depth` (m) deep under its load: the impulse of a substep times
/// 1/m_a + 1/m_b (m/s).
inline double next_pad(double pad, double depth, double load, const ContactPadding& padding) {
  /// m; thicker ones grow the slower: what presses that much sways slowly.
  constexpr double kThickPad = 4e-3;
  const double thickest = padding.per_load * load, gives_way = pad + depth;
  const double slower = gives_way > kThickPad ? std::sqrt(kThickPad / gives_way) : 1;
  const double next = std::abs(depth) < padding.slack * pad ? pad : pad + padding.learnt * slower * depth;
  return std::clamp(next, 0.0, thickest);
}

}  // namespace truestep
