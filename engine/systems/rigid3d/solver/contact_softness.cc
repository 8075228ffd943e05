#include "engine/systems/rigid3d/solver/contact_softness.h"

#include <numbers>

namespace truestep::rigid3d {

namespace {

/// Offsets stay unchanged while depths are below this fraction of them.
constexpr double kOffsetSlack = 0.5;
/// Rate of contact springs as a fraction of the substeps' rate; from 0.14 on slow modes of walls grow
/// (docs/standing.md).
constexpr double kContactHertzShare = 0.13;

double hertz_at(const SolverSettings& settings, double rate) {
  return settings.contact_hertz.value_or(kContactHertzShare * rate);
}

}  // namespace

double contact_rate(const SolverSettings& settings, double h) {
  return 2 * std::numbers::pi * hertz_at(settings, 1 / h);
}

SoftConstraint<double> contact_softness(const SolverSettings& settings, double h) {
  return soft_constraint<double>(hertz_at(settings, 1 / h), settings.contact_damping_ratio, h);
}

PenetrationOffsetRule penetration_offset_rule(const SolverSettings& settings, double h) {
  const double rate = settings.substeps / h;
  return truestep::penetration_offset_rule(hertz_at(settings, rate), rate, h, kOffsetSlack);
}

}  // namespace truestep::rigid3d
