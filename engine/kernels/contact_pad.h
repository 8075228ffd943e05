// Pads between surfaces that press: a soft contact of frequency w gives way by load / (m w^2), and stacks
// would sink by the sum of it. Each contact therefore carries a pad that follows, slowly, how deep its load
// presses it in, until the surfaces just touch: the integral part of a controller whose spring is the
// proportional one.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

namespace truestep {

/// How the pads of contacts follow their loads.
struct ContactPadding {
  double learnt = 0;    ///< share of a depth that is added in a step
  double per_load = 0;  ///< s, times the load: the thickest pad
};

/// For contacts of `hertz` solved at `rate` (1/s) in steps of h (s).
inline ContactPadding contact_padding(double hertz, double rate, double h) {
  /// s in which a contact takes back how far its load presses it in. Slower than the stacks it carries sway.
  constexpr double kPadTime = 1;
  /// A pad is at most that many times what the spring gives way under its load, so that none outlasts it.
  constexpr double kMostPad = 4;
  const double w = 2 * std::numbers::pi * hertz;
  return {h / (h + kPadTime), w > 0 ? kMostPad * rate / (w * w) : 0};
}

/// The pad (m) of a contact that was `depth` (m) deep under its load: the impulse of a substep times
/// 1/m_a + 1/m_b (m/s).
inline double next_pad(double pad, double depth, double load, const ContactPadding& padding) {
  /// m; thicker ones grow the slower: what presses that much sways slowly.
  constexpr double kThickPad = 4e-3;
  const double gives_way = pad + depth;
  const double slower = gives_way > kThickPad ? std::sqrt(kThickPad / gives_way) : 1;
  return std::clamp(pad + padding.learnt * slower * depth, 0.0, padding.per_load * load);
}

}  // namespace truestep
