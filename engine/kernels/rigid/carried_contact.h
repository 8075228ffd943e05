// Where a turning body carries a contact within a step. Contacts are found once a step (s) and the solver's
// rows are linear: a body with the velocity v and the spin w carries what touches it at the arm r along
// v + w x r, straight on, and what should go round in a circle leaves it by w^2 h r / 2 a second. The mean
// over a step h of the velocity at the place of the contact is
//   v + w x (C r + h d / 2),    C = 1/h int_0^h exp(t [W]) dt = 1 + (1 - cos a) / a [n] + (1 - sin a / a)
//   [n]^2
// with the spin W = a n / h at which the place itself goes round, and the velocity d by which it moves beyond
// that. What rests on a turntable goes round with it, W = w and d = 0, and stays for ever: v + w x C r is the
// chord. Substeps follow the velocity as it changes: friction that had to turn it at once, in the first of
// them, would slip. The place where a ball touches does not go round with the ball: W = 0. That of a face on
// a face goes round with what it lies on, whatever speed and spin the body has at the end of a step: its load
// moves on among its corners and rocks it from substep to substep, and it ends every step along a chord.
#pragma once
#include <cmath>

#include "engine/kernels/rigid/free_rotation.h"
#include "engine/math/trig.h"
#include "engine/math/vec3.h"

namespace truestep::carried {

/// The mean of r over a step in which it turns by `turn` (rad), minus r.
inline Vec3 mean_turn(const Vec3& turn, const Vec3& r) {
  const double a2 = norm2(turn);
  double once, twice;  // (1 - cos a) / a^2, (a - sin a) / a^3
  if (a2 < 1e-2) {
    once = 0.5 - a2 * (1.0 / 24 - a2 * (1.0 / 720 - a2 / 40320));
    twice = 1.0 / 6 - a2 * (1.0 / 120 - a2 * (1.0 / 5040 - a2 / 362880));
  } else {
    const double a = std::sqrt(a2);
    const trig::SinCos turned = trig::sincos(a);
    once = (1 - turned.cos) / a2, twice = (a - turned.sin) / (a2 * a);
  }
  const Vec3 c = cross(turn, r);
  return c * once + cross(turn, c) * twice;
}

/// What the velocity of a surface exceeds that of the solver's rows by.
struct Carried {
  Vec3 mean;          ///< m/s, in the middle of the step: so that the sum over its substeps is exact
  Vec3 rate;          ///< m/s^2, in the middle of the step as well
  Vec3 turns{};       ///< rad/s, at which the place goes round, and friction there
  bool lies = false;  ///< a face on a face, which turns its normal along
};

/// Of a body with this spin at the place of a contact, beyond spin x solved. `arm` (m) leads there at the
/// start of the step of h (s), `solved` is the arm of the solver's rows; the place goes round at the rate
/// `turns` (rad/s) and moves at `drift` (m/s) relative to that and to the body's centre.
inline Carried excess(const Vec3& spin, const Vec3& arm, const Vec3& solved, const Vec3& turns,
                      const Vec3& drift, double h) {
  return {cross(spin, arm + mean_turn(turns * h, arm) + drift * (0.5 * h) - solved),
          cross(spin, cross(turns, arm + cross(turns, arm) * (0.5 * h)) + drift)};
}

/// One of the two bodies of a contact, in space or in the plane (spins about z then).
struct Side {
  Vec3 velocity, spin;
  bool moves = true;            ///< forces move it
  bool round = false;           ///< it is round there: the place does not go with its material
  Vec3 turns;                   ///< spin at which the place goes round with it
  double reach = 0;             ///< m, from its centre to its farthest surface
  double mass = 0, moment = 0;  ///< kg and kg m^2, of what may roll on a turning face about its normal
};

/// Where a contact was found.
struct Found {
  Vec3 on_a, on_b;   ///< m, the arms of the solver's rows, from the centres when it was found
  Vec3 apart;        ///< m, from the centre of a to that of b at the start of the step
  double ahead = 0;  ///< s after the start of the step
  Vec3 flat;         ///< the normal, where a face lies on a face; otherwise zero
};

/// The spin of what lies flat on something with that spin: it turns freely about the normal only. What it has
/// beside that is how it rocks from substep to substep as its load moves on among its corners.
inline Vec3 spin_lying(const Vec3& own, const Vec3& under, const Vec3& normal) {
  return under + normal * dot(normal, own - under);
}

/// To be added to the velocity of b relative to a at the place of a contact.
inline Carried velocity(Side a, Side b, const Found& found, double h) {
  // The place goes with what is round, or with the smaller body: it stands on the larger one.
  const bool with_b = a.round != b.round ? b.round : a.moves != b.moves ? b.moves : b.reach < a.reach;
  Side &leader = with_b ? b : a, &other = with_b ? a : b;
  const bool lies = !leader.round && found.flat != Vec3{};
  if (lies) leader.turns = leader.spin = spin_lying(leader.spin, other.spin, found.flat);
  const Vec3 &turns = leader.turns, &from = with_b ? found.on_b : found.on_a;
  // Back to the start of the step, with the body that the place goes with.
  const Vec3 back = found.ahead > 0 ? rotation(free_rotation::turn(turns * -found.ahead)).apply(from) : from;
  const Vec3 between = with_b ? found.apart : -found.apart, there = back + between;
  // m/s at which the place leaves an arm of the other body that goes round at the place's rate. What lies
  // stays where it is: its speed at the end of a step, along a chord, tells of no other.
  const Vec3 passes = lies ? cross(other.spin, between) : leader.velocity - other.velocity;
  Vec3 drift = passes - cross(turns, between);
  // A body that rolls on the other turns its velocity by this share of the change of what is under it.
  const bool rolls = leader.round && leader.moves && leader.moment > 0;
  const double follows = rolls ? leader.moment / (leader.moment + leader.mass * norm2(back)) : 0;
  drift += cross(other.spin, drift) * (0.5 * h * follows);
  const Carried of_leader = excess(leader.spin, back, from, turns, {}, h),
                of_other = excess(other.spin, there, with_b ? found.on_a : found.on_b, turns, drift, h);
  const Carried &of_a = with_b ? of_other : of_leader, &of_b = with_b ? of_leader : of_other;
  return {of_b.mean - of_a.mean, of_b.rate - of_a.rate, turns, lies};
}

}  // namespace truestep::carried
