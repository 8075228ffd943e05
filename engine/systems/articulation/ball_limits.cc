#include "engine/systems/articulation/ball_limits.h"

#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"

namespace truestep::articulation {

namespace {

/// An excess over a limit: how far (rad), and the gradient of the limited angle.
struct Beyond {
  double by = 0;
  Vec3 along;
};
struct BothBeyond {
  Beyond twist, swing;
};

BothBeyond beyond(const Drive& d, const Vec3& a, const double* q) {
  const double n = 1 / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  // The sign for which the twist is within half a turn.
  const double sign = q[0] < 0 ? -n : n, w = q[0] * sign;
  const Vec3 u{q[1] * sign, q[2] * sign, q[3] * sign};
  const double p = dot(u, a), c2 = w * w + p * p;
  const Vec3 across = cross(a, u);
  BothBeyond out;
  if (d.limits != Drive::Limits::none && c2 > 1e-12) {
    const double twist = 2 * trig::atan2(p, w);
    const bool low = d.limits != Drive::Limits::upper, high = d.limits != Drive::Limits::lower;
    const Vec3 g = (a * (w * w) + across * w + u * p) / c2;
    if (low && twist < d.lowest) out.twist = {d.lowest - twist, -g};
    if (high && twist > d.highest) out.twist = {twist - d.highest, g};
  }
  if (d.cone < kNoCone) {
    const double c = std::sqrt(c2), s = std::sqrt(std::max(0.0, 1 - c2));
    const double swing = 2 * trig::atan2(s, c);
    if (swing > d.cone && c * s > 1e-12)
      out.swing = {swing - d.cone, (u * w - a * (p * w) - across * p) / (c * s)};
  }
  return out;
}

void add_push(const Drive& d, const Beyond& b, const Vec3& omega, BallLimit& out) {
  if (!(b.by > 0)) return;
  const double effort = std::max(0.0, d.limit_stiffness * b.by + d.limit_damping * dot(b.along, omega));
  out.torque -= b.along * effort;
  out.energy += 0.5 * d.limit_stiffness * b.by * b.by;
}

void add_slope(double k, const Vec3& along, DriveSlope& out) {
  const double v[] = {along.x, along.y, along.z};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) out.stiffness[i][j] += k * v[i] * v[j];
  }
}

}  // namespace

BallLimit ball_limit(const Drive& d, const Vec3& axis, const double* q, const Vec3& omega) {
  BallLimit out;
  const BothBeyond b = beyond(d, axis, q);
  add_push(d, b.twist, omega, out);
  add_push(d, b.swing, omega, out);
  return out;
}

void add_ball_limit_slope(const Drive& d, const Vec3& axis, const double* q, DriveSlope& out) {
  const BothBeyond b = beyond(d, axis, q);
  if (b.twist.by > 0) add_slope(d.limit_stiffness, b.twist.along, out);
  if (b.swing.by > 0) add_slope(d.limit_stiffness, b.swing.along, out);
}

}  // namespace truestep::articulation
