// Torque-free rotation for steps of any size. free_rotation::advance turns a body in at most kMostParts
// parts; one that turns farther in each of them than its method can follow kept its momentum, but not its
// energy: at 1e6 rad/s and 60 Hz it doubled. Here it keeps both; the phase of its motion, thousands of
// radians, is lost.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/kernels/rigid/free_rotation.h"

namespace truestep::free_rotation {

/// The orientation nearest to q in which a body with the angular momentum L (in the world) has the kinetic
/// energy `twice` / 2, or as close to it as there is one: L moves in the body's frame towards the axis of the
/// largest or the smallest moment,  m_i^2 <- (1 - s) m_i^2,  and + s |L|^2 on that axis.
inline Quat with_energy(const Quat& q, const Vec3& L, const Vec3& I, double twice) {
  const double all = norm2(L);
  if (!(all > 0)) return q;
  const Vec3 m = rotation(q).apply_inverse(L);
  const double now = dot(m, divide(m, I)), inverse[3] = {1 / I.x, 1 / I.y, 1 / I.z};
  const auto [low, high] = std::minmax_element(inverse, inverse + 3);
  const double* axis = now > twice ? low : high;
  const double extreme = all * *axis;
  // Rounding, or moments that are nearly equal.
  if (!(std::abs(now - extreme) > 1e-9 * now)) return q;
  const double s = std::clamp((now - twice) / (now - extreme), 0.0, 1.0);
  double to[3] = {m.x, m.y, m.z};
  for (int k = 0; k < 3; ++k) {
    const double square = (1 - s) * to[k] * to[k] + (inverse + k == axis ? s * all : 0);
    to[k] = std::copysign(std::sqrt(square), to[k]);
  }
  // R(q) takes m to L: the rotation that takes `to` to m comes before it. No component changes its sign, so
  // that they are at most a right angle apart.
  const Vec3 from{to[0], to[1], to[2]}, turn = cross(from, m);
  return normalized(q * normalized(Quat{all + dot(from, m), turn.x, turn.y, turn.z}));
}

/// advance(m, I, t), with the same energy at any speed.
inline Motion advance_fast(const Motion& m, const Vec3& I, double t) {
  const Motion end = advance(m, I, t);
  if (norm(m.angular_velocity) * t < kTurn * kMostParts) return end;
  const Vec3 L = momentum(m, I);
  const Quat q = with_energy(end.orientation, L, I, dot(m.angular_velocity, L));
  return {q, spin_of(q, L, I)};
}

}  // namespace truestep::free_rotation
