#include "engine/systems/rigid3d/contact_softness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace truestep {

namespace {

/// Contacts are springs of this share of the substeps' rate; from twice that on stacks shiver.
constexpr double kContactHertzShare = 0.2;
/// s in which a contact takes back how far its load presses it in. Slower than the stacks it carries sway.
constexpr double kPadTime = 1;
/// m; thicker ones grow the slower: what presses that much sways slowly.
constexpr double kThickPad = 4e-3;
/// A pad is at most that many times what the spring gives way under its load, so that none outlasts it.
constexpr double kMostPad = 4;

}  // namespace

SoftConstraint<double> contact_softness(const SolverSettings& settings, double h) {
  return soft_constraint<double>(settings.contact_hertz.value_or(kContactHertzShare / h),
                                 settings.contact_damping, h);
}

ContactPadding contact_padding(const SolverSettings& settings, double h) {
  const double rate = settings.substeps / h,
               w = 2 * std::numbers::pi * settings.contact_hertz.value_or(kContactHertzShare * rate);
  return {h / (h + kPadTime), w > 0 ? kMostPad * rate / (w * w) : 0};
}

double next_pad(double pad, double depth, double load, const ContactPadding& padding) {
  const double gives_way = pad + depth;
  const double slower = gives_way > kThickPad ? std::sqrt(kThickPad / gives_way) : 1;
  return std::clamp(pad + padding.learnt * slower * depth, 0.0, padding.per_load * load);
}

}  // namespace truestep
