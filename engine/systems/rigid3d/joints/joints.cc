#include "engine/systems/rigid3d/joints/joints.h"

#include <algorithm>
#include <cmath>

#include "engine/kernels/rigid/free_rotation.h"
#include "engine/math/trig.h"
#include "engine/rigid/constraint_colouring.h"

namespace truestep::rigid3d {
namespace {

constexpr double kFullTurn = 6.283185307179586;
/// Smallest cosine of the second Cardan angle: closer to a quarter turn the first and third axes coincide.
constexpr double kLeastCosine = 0.02;

Vec3 column(const Rotation& r, int k) {
  const auto at = [k](const Vec3& v) { return k == 0 ? v.x : k == 1 ? v.y : v.z; };
  return {at(r.row[0]), at(r.row[1]), at(r.row[2])};
}
Quat conjugate(const Quat& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

/// Angles x of a, then y, then z of b, and the axes dual to those of the rotations.
void cardan(const Rotation& a, const Rotation& b, JointPlace& p) {
  const Vec3 x = column(a, 0), y = column(a, 1), z = column(a, 2), zb = column(b, 2);
  const double xx = dot(x, column(b, 0)), xy = dot(x, column(b, 1)), xz = dot(x, zb);
  p.coordinate[3] = trig::atan2(-dot(y, zb), dot(z, zb));
  p.coordinate[4] = trig::atan2(xz, std::sqrt(xx * xx + xy * xy));
  p.coordinate[5] = trig::atan2(-xy, xx);
  const Vec3 across = cross(zb, x);
  const Vec3 n = normalized(across, y);
  const double cosine = std::max(kLeastCosine, norm(across));
  p.turns[0] = cross(n, zb) / cosine, p.turns[1] = n, p.turns[2] = cross(x, n) / cosine;
}

/// Twist about the axis and swing of the axis: their rates are (e_a + e_b) / (1 + cos) and e_a x e_b / sin.
void swing_twist(const Rotation& a, const Rotation& b, const Quat& turned, JointPlace& p) {
  const Vec3 ea = column(a, 0), eb = column(b, 0), across = cross(ea, eb);
  const double sine = norm(across), cosine = dot(ea, eb);
  p.coordinate[3] = 2 * trig::atan2(turned.x, turned.w);
  p.coordinate[4] = trig::atan2(sine, cosine);
  p.turns[0] = (ea + eb) / std::max(kLeastCosine, 1 + cosine);
  p.turns[1] = normalized(across, column(a, 1)), p.turns[2] = column(a, 2);
}

}  // namespace

double unwrapped(double angle, double near) {
  return angle + kFullTurn * std::round((near - angle) / kFullTurn);
}

JointPlace joint_place(const Joint& joint, const Pose& a, const Pose& b) {
  JointPlace p;
  p.arm_a = rotation(a.orientation).apply(joint.anchor_a);
  p.arm_b = rotation(b.orientation).apply(joint.anchor_b);
  p.gap = (b.position - a.position) + (p.arm_b - p.arm_a);
  const Rotation slides = rotation(a.orientation * joint.slide_frame);
  for (int e = 0; e < 3; ++e) p.axes[e] = column(slides, e), p.coordinate[3 + e] = 0;
  if (joint.form == Joint::Form::line) {
    const double length = norm(p.gap);
    p.axes[0] = length > 0 ? p.gap / length : p.axes[0];
  }
  for (int e = 0; e < 3; ++e) p.coordinate[e] = dot(p.axes[e], p.gap);
  if (joint.form == Joint::Form::line) p.coordinate[0] -= joint.length;

  if (joint.form == Joint::Form::free || joint.form == Joint::Form::line) {
    std::copy(p.axes, p.axes + 3, p.turns);
    return p;
  }
  const Quat qa = a.orientation * joint.turn_a, qb = b.orientation * joint.turn_b;
  const Rotation ra = rotation(qa);
  for (int e = 0; e < 3; ++e) p.turns[e] = column(ra, e);
  switch (joint.form) {
    case Joint::Form::free:
    case Joint::Form::line:
    case Joint::Form::gear:
      break;
    case Joint::Form::locked:
    case Joint::Form::pose: {
      const Vec3 turn = free_rotation::rotation_vector(conjugate(qa) * qb);
      p.coordinate[3] = turn.x, p.coordinate[4] = turn.y, p.coordinate[5] = turn.z;
      break;
    }
    case Joint::Form::hinge: {
      const Quat turned = conjugate(qa) * qb;
      const Vec3 tilt = cross(p.turns[0], column(rotation(qb), 0));
      const double angle = 2 * trig::atan2(turned.x, turned.w);
      p.coordinate[3] = unwrapped(angle, 0);
      p.coordinate[4] = dot(p.turns[1], tilt), p.coordinate[5] = dot(p.turns[2], tilt);
      break;
    }
    case Joint::Form::cardan:
      cardan(ra, rotation(qb), p);
      break;
    case Joint::Form::swing_twist:
      swing_twist(ra, rotation(qb), conjugate(qa) * qb, p);
      p.coordinate[3] = unwrapped(p.coordinate[3], 0);
      break;
  }
  return p;
}

}  // namespace truestep::rigid3d
