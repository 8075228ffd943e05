// Interpolation of orientations between keys. Along the shorter arc between neighbours, with log and exp of
// quaternions,
//   slerp(a, b, s) = a exp(s log(a* b))                                        (Shoemake 1985)
//   squad(u) = slerp(slerp(q0, q1, u), slerp(s0, s1, u), 2 u (1 - u)),
//   s_i = q_i exp(-(log(q_i* q_{i+1}) + log(q_i* q_{i-1})) / 4)                (Shoemake 1987)
// slerp has constant angular velocity between keys, which jumps at keys; squad has no such corners; nlerp
// follows slerp's arc at varying speed, at most 0.92 degrees off on a quarter turn, for the cost of a square
// root.
#pragma once
#include <span>
#include <vector>

#include "engine/kernels/animation/key_curve.h"
#include "engine/kernels/rigid/free_rotation.h"

namespace truestep::animation {

constexpr Quat conjugate(const Quat& q) {
  return {q.w, -q.x, -q.y, -q.z};
}
/// v rotated by the unit quaternion q.
constexpr Vec3 rotate(const Quat& q, const Vec3& v) {
  const Vec3 u{q.x, q.y, q.z}, t = cross(u, v) * 2.0;
  return v + t * q.w + cross(u, t);
}
/// The rotation by `angle` (rad) about a unit axis.
inline Quat turn_about(const Vec3& axis, double angle) {
  const auto [s, c] = trig::sincos(0.5 * angle);
  return {c, s * axis.x, s * axis.y, s * axis.z};
}
/// b or -b, whichever is nearer to a.
constexpr Quat nearer(const Quat& a, const Quat& b) {
  return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z < 0 ? Quat{-b.w, -b.x, -b.y, -b.z} : b;
}

/// Rotation at constant angular velocity along the shorter arc; a and b are unit quaternions.
Quat slerp(const Quat& a, const Quat& b, double s);
/// squad's inner control point at q, between its neighbours.
Quat squad_point(const Quat& before, const Quat& q, const Quat& after);
/// From q0 (u = 0) to q1 (u = 1) with the inner control points s0, s1.
Quat squad(const Quat& q0, const Quat& s0, const Quat& s1, const Quat& q1, double u);

/// Decomposition of a rotation: q = swing twist, the twist about the unit `axis` (rad, in (-pi, pi]), the
/// swing about an axis perpendicular to it.
struct SwingTwist {
  Quat swing;
  double twist = 0;
};
SwingTwist swing_twist(const Quat& q, const Vec3& axis);

enum class Turning : uint8_t { step, nlerp, slerp, squad };

/// Orientations at ascending times.
class RotationCurve {
 public:
  RotationCurve() = default;
  /// `keys`: as many unit quaternions as times, at least one.
  RotationCurve(std::span<const double> times, std::span<const Quat> keys, Turning turning, Extend extend);
  Quat sample(double t) const;
  double first() const { return times_.front(); }
  double last() const { return times_.back(); }

 private:
  std::vector<double> times_;
  std::vector<Quat> keys_, inner_;
  Turning turning_ = Turning::slerp;
  Extend extend_ = Extend::clamp;
};

}  // namespace truestep::animation
