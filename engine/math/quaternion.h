// Unit quaternions (w, x, y, z) for orientations: q rotates body vectors into the world, q and -q are the
// same rotation. Only what poses need; integration of orientations belongs to the systems that have them.
#pragma once
#include <array>
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep {

struct Quat {
  double w = 1, x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Quat&, const Quat&) = default;
};

/// Hamilton product: first b, then a.
constexpr Quat operator*(const Quat& a, const Quat& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
/// q / |q|, the identity when q is zero or not finite.
inline Quat normalized(const Quat& q) {
  const double n = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(n > 0) || !std::isfinite(n)) return {};
  return {q.w / n, q.x / n, q.y / n, q.z / n};
}

/// Three rows of a rotation matrix.
struct Rotation {
  Vec3 row[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  /// Body to world.
  constexpr Vec3 apply(const Vec3& p) const { return {dot(row[0], p), dot(row[1], p), dot(row[2], p)}; }
  /// World to body.
  constexpr Vec3 apply_inverse(const Vec3& p) const { return row[0] * p.x + row[1] * p.y + row[2] * p.z; }
};

/// Matrix of a unit quaternion.
constexpr Rotation rotation(const Quat& q) {
  const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
  const double xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
  const double wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{{1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)},
           {2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx)},
           {2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)}}};
}

/// Normalised linear interpolation along the shorter arc, s in [0, 1].
inline Quat nlerp(const Quat& a, Quat b, double s) {
  if (a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z < 0) b = {-b.w, -b.x, -b.y, -b.z};
  return normalized(
      Quat{a.w + s * (b.w - a.w), a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), a.z + s * (b.z - a.z)});
}

/// Shortest rotation that takes unit vector a to unit vector b; half a turn when they are opposite.
inline Quat rotation_between(const Vec3& a, const Vec3& b) {
  const double c = dot(a, b);
  if (c < -1 + 1e-12) {
    const Vec3 axis = normalized(std::fabs(a.x) < 0.9 ? cross(a, Vec3{1, 0, 0}) : cross(a, Vec3{0, 1, 0}));
    return {0, axis.x, axis.y, axis.z};
  }
  const Vec3 v = cross(a, b);
  return normalized(Quat{1 + c, v.x, v.y, v.z});
}

}  // namespace truestep
