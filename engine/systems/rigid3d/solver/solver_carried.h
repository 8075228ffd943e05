// The place of a contact in a step, and how far the straight motion of the solver's rows misses it
// (engine/kernels/rigid/carried_contact.h).
#pragma once
#include "engine/kernels/rigid/carried_contact.h"
#include "engine/systems/rigid3d/contacts.h"

namespace truestep::rigid3d {

/// To be added to the velocity of b relative to a at `center` (m, from the centre of a as the contact was
/// found; `pressed`: the contact bore a load in the last step). Zero unless one of them turns and carries the
/// other: a body moved from outside, or one that `carries`, as on an axle.
struct CarriedPair {
  const BodyKind *kind_a, *kind_b;
  const BodyNow *now_a, *now_b;
  Vec3 velocity_a, velocity_b, spin_a, spin_b;
};
carried::Carried carried_velocity(const Contact& c, const CarriedPair& pair, const Vec3& center, double h);

/// m/s^2, at which the velocity of a body that is led changes at this arm (m); zero for others.
inline Vec3 led_rate(const State& s, size_t body, const Vec3& arm) {
  if (!is_led(s.f64(columns::sleep_timer).data(), body)) return {};
  const double* rates = s.f64(columns::sleep_middle).data();
  return load3(rates, 2 * body) + cross(load3(rates, 2 * body + 1), arm);
}

}  // namespace truestep::rigid3d
