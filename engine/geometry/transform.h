// Rigid placement as a matrix, computed once per step from a pose: x_world = R x_body + p.
#pragma once
#include "engine/geometry/shape.h"
#include "engine/math/quaternion.h"

namespace truestep {

struct Transform {
  Rotation rotation;
  Vec3 position;

  constexpr Vec3 point(const Vec3& p) const { return rotation.apply(p) + position; }
  constexpr Vec3 direction(const Vec3& d) const { return rotation.apply(d); }
  constexpr Vec3 inverse_point(const Vec3& p) const { return rotation.apply_inverse(p - position); }
  constexpr Vec3 inverse_direction(const Vec3& d) const { return rotation.apply_inverse(d); }
};

/// From a pose with a unit orientation.
constexpr Transform transform_of(const Pose& pose) {
  return {rotation(pose.orientation), pose.position};
}
/// Axis i (0 to 2) of the body in the world: column i of R.
constexpr Vec3 axis(const Rotation& r, int i) {
  return i == 0   ? Vec3{r.row[0].x, r.row[1].x, r.row[2].x}
         : i == 1 ? Vec3{r.row[0].y, r.row[1].y, r.row[2].y}
                  : Vec3{r.row[0].z, r.row[1].z, r.row[2].z};
}
/// First b, then a.
constexpr Rotation operator*(const Rotation& a, const Rotation& b) {
  const auto row = [&](int i) { return b.apply_inverse(a.row[i]); };
  return {{row(0), row(1), row(2)}};
}
constexpr Transform operator*(const Transform& a, const Transform& b) {
  return {a.rotation * b.rotation, a.point(b.position)};
}
/// R transposed.
constexpr Rotation inverse(const Rotation& r) {
  return {{axis(r, 0), axis(r, 1), axis(r, 2)}};
}
constexpr Transform inverse(const Transform& t) {
  return {inverse(t.rotation), t.inverse_direction(-t.position)};
}
/// b relative to a: inverse(a) * b.
constexpr Transform relative(const Transform& a, const Transform& b) {
  return {inverse(a.rotation) * b.rotation, a.inverse_point(b.position)};
}

}  // namespace truestep
