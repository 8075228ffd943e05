// Vectors, rotations and poses of the plane x, y. A rotation is kept as cosine and sine.
#pragma once
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep::flat {

struct Vec2 {
  double x = 0, y = 0;

  friend constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vec2 operator-(Vec2 a) { return {-a.x, -a.y}; }
  friend constexpr Vec2 operator*(double s, Vec2 a) { return {s * a.x, s * a.y}; }
  friend constexpr bool operator==(const Vec2&, const Vec2&) = default;
};

constexpr double dot(Vec2 a, Vec2 b) {
  return a.x * b.x + a.y * b.y;
}
/// z component of a x b.
constexpr double cross(Vec2 a, Vec2 b) {
  return a.x * b.y - a.y * b.x;
}
inline double norm(Vec2 a) {
  return std::sqrt(dot(a, a));
}
/// a turned by +90 degrees.
constexpr Vec2 left_of(Vec2 a) {
  return {-a.y, a.x};
}
/// a rotated by -90 degrees: the outward direction of an edge of a counter-clockwise polygon.
constexpr Vec2 right_of(Vec2 a) {
  return {a.y, -a.x};
}
/// a / |a|, or `fallback` when a is zero.
inline Vec2 unit(Vec2 a, Vec2 fallback = {1, 0}) {
  const double n = norm(a);
  return n > 0 ? (1 / n) * a : fallback;
}
constexpr Vec2 flatten(const Vec3& a) {
  return {a.x, a.y};
}

struct Rotation {
  double c = 1, s = 0;

  constexpr Vec2 operator*(Vec2 a) const { return {c * a.x - s * a.y, s * a.x + c * a.y}; }
  /// The inverse rotation of a.
  constexpr Vec2 back(Vec2 a) const { return {c * a.x + s * a.y, c * a.y - s * a.x}; }
  /// The rotation that turns this one's frame into that of b: inverse(this) b.
  constexpr Rotation to(Rotation b) const { return {c * b.c + s * b.s, c * b.s - s * b.c}; }
};

/// x -> p + q x.
struct Pose {
  Vec2 p;
  Rotation q;

  constexpr Vec2 operator*(Vec2 a) const { return p + q * a; }
  constexpr Vec2 back(Vec2 a) const { return q.back(a - p); }
  /// Pose of b seen from this one.
  constexpr Pose to(const Pose& b) const { return {q.back(b.p - p), q.to(b.q)}; }
};

}  // namespace truestep::flat
