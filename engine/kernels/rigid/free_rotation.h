// Torque-free rotation of a body: its angular momentum L is constant and its orientation q follows
//   q' = 1/2 (0, w) q,   w = R(q) I^-1 R(q)^T L        (I = diag(I1, I2, I3) in the body's frame).
// Spherical and symmetric bodies in closed form: with I1 = I2 the motion is a rotation about the body's axis
// followed by one about L,  q(t) = exp(t L / I1) q exp(t (1/I3 - 1/I1) (L . e3) e3)  (Landau, Lifshitz I,
// section 33). Other bodies by the classical fourth-order Runge-Kutta method on q, in parts of the step in
// which the body turns by at most kTurn; L is kept to the bit, so that only the energy has an error, 1e-9 of
// it in thousands of revolutions.
#pragma once
#include "engine/math/quaternion.h"
#include "engine/math/trig.h"

namespace truestep::free_rotation {

/// Rotation in one part of a step (rad), and the largest number of parts: more than bodies of 100 revolutions
/// a second need at 60 Hz.
inline constexpr double kTurn = 0.03;
inline constexpr int kMostParts = 512;

/// Quaternion exponential of a rotation vector (rad).
inline Quat turn(const Vec3& a) {
  const double angle = norm(a);
  // Series of sin(x/2)/x, exact to the last bit below 1e-4; the quotient would divide small numbers.
  if (angle < 1e-4) {
    const double s = 0.5 - angle * angle / 48;
    return normalized(Quat{1 - angle * angle / 8, s * a.x, s * a.y, s * a.z});
  }
  const auto [sin, cos] = trig::sincos(0.5 * angle);
  const double s = sin / angle;
  return {cos, s * a.x, s * a.y, s * a.z};
}

/// Rotation vector (rad, at most pi) of a unit quaternion.
inline Vec3 rotation_vector(const Quat& q) {
  const Vec3 v{q.x, q.y, q.z};
  const double s = norm(v);
  if (s < 1e-9) return v * (q.w < 0 ? -2.0 : 2.0);
  const double half = trig::atan2(q.w < 0 ? -s : s, q.w < 0 ? -q.w : q.w);
  return v * (2 * half / s);
}

struct Motion {
  Quat orientation;
  Vec3 angular_velocity;  ///< rad/s, in the world
};

inline Vec3 divide(const Vec3& a, const Vec3& b) {
  return {a.x / b.x, a.y / b.y, a.z / b.z};
}
inline Vec3 times(const Vec3& a, const Vec3& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

/// Angular momentum (kg m^2/s, in the world) of a body with principal moments I.
inline Vec3 momentum(const Motion& m, const Vec3& I) {
  const Rotation r = rotation(m.orientation);
  return r.apply(times(I, r.apply_inverse(m.angular_velocity)));
}

/// Change of angular velocity (rad/s) due to a change of angular momentum (kg m^2/s), both in the world.
inline Vec3 spin_of(const Quat& q, const Vec3& momentum, const Vec3& I) {
  const Rotation r = rotation(q);
  return r.apply(divide(r.apply_inverse(momentum), I));
}

namespace detail {
inline Vec3 velocity(const Quat& q, const Vec3& L, const Vec3& I) {
  const Rotation r = rotation(normalized(q));
  return r.apply(divide(r.apply_inverse(L), I));
}
inline Quat rate(const Quat& q, const Vec3& w) {
  const Quat p = Quat{0, w.x, w.y, w.z} * q;
  return {0.5 * p.w, 0.5 * p.x, 0.5 * p.y, 0.5 * p.z};
}
inline Quat plus(const Quat& q, const Quat& d, double h) {
  return {q.w + h * d.w, q.x + h * d.x, q.y + h * d.y, q.z + h * d.z};
}
}  // namespace detail

/// The motion after t (s); all moments must be positive.
inline Motion advance(const Motion& m, const Vec3& I, double t) {
  if (I.x == I.y && I.y == I.z) {
    return {normalized(turn(m.angular_velocity * t) * m.orientation), m.angular_velocity};
  }
  const Vec3 L = momentum(m, I);
  Quat q = m.orientation;
  const bool xy = I.x == I.y, yz = I.y == I.z, zx = I.z == I.x;
  if (xy || yz || zx) {
    const Vec3 axis = xy ? Vec3{0, 0, 1} : yz ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const double across = xy ? I.x : yz ? I.y : I.z, along = dot(axis, I);
    const double share = dot(axis, rotation(q).apply_inverse(L)) * (1 / along - 1 / across);
    q = normalized(turn(L * (t / across)) * q * turn(axis * (share * t)));
  } else {
    const double angle = norm(m.angular_velocity) * t;
    const int parts = angle < kTurn                ? 1
                      : angle < kTurn * kMostParts ? static_cast<int>(angle / kTurn) + 1
                                                   : kMostParts;
    const double h = t / parts;
    for (int k = 0; k < parts; ++k) {
      using namespace detail;
      const Quat k1 = rate(q, velocity(q, L, I));
      const Quat q2 = plus(q, k1, 0.5 * h), k2 = rate(q2, velocity(q2, L, I));
      const Quat q3 = plus(q, k2, 0.5 * h), k3 = rate(q3, velocity(q3, L, I));
      const Quat q4 = plus(q, k3, h), k4 = rate(q4, velocity(q4, L, I));
      q = normalized(plus(plus(plus(plus(q, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6));
    }
  }
  return {q, detail::velocity(q, L, I)};
}

/// (I2 - I3) / I1 and so on:  w1' = (I2 - I3) / I1 w2 w3  in torque-free rotation.
inline Vec3 spin_ratios(const Vec3& I) {
  return {(I.y - I.z) / I.x, (I.z - I.x) / I.y, (I.x - I.y) / I.z};
}
/// Change of the angular velocity (rad/s, along the principal axes) in t (s) of torque-free rotation, by one
/// step of the classical fourth-order Runge-Kutta method; for rotations by a fraction of a radian.
inline Vec3 spin_change(const Vec3& spin, const Vec3& ratios, double t) {
  const auto rate = [&](const Vec3& w) { return times(ratios, {w.y * w.z, w.z * w.x, w.x * w.y}); };
  const Vec3 k1 = rate(spin), k2 = rate(spin + k1 * (0.5 * t)), k3 = rate(spin + k2 * (0.5 * t)),
             k4 = rate(spin + k3 * t);
  return (k1 + (k2 + k3) * 2.0 + k4) * (t / 6);
}

}  // namespace truestep::free_rotation
