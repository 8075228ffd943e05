// Signed distance of a point to the four convex solids, in their own frames: d < 0 inside, n = grad d (unit).
// Each d is convex in the point and grows by at most the distance moved, which is what first_contact.h needs.
// Box: d = |max(q, 0)| + min(max_i q_i, 0) with q = |p| - half (Quilez, "Distance functions").
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep {

/// Signed distance (m) and outward unit normal.
template <class T>
struct SurfaceDistance {
  T d = 0;
  Vec3T<T> n;
};

/// Half space below the plane through the origin with unit normal n.
template <class T>
constexpr SurfaceDistance<T> plane_distance(const Vec3T<T>& p, const Vec3T<T>& n) {
  return {dot(p, n), n};
}

/// Ball of radius r (m) about the origin; the normal at the centre is +y.
template <class T>
SurfaceDistance<T> sphere_distance(const Vec3T<T>& p, T r) {
  const T l = norm(p);
  return {l - r, l > 0 ? p / l : Vec3T<T>{0, 1, 0}};
}

/// Points within r of the segment from (0, -half_length, 0) to (0, half_length, 0).
template <class T>
SurfaceDistance<T> capsule_distance(const Vec3T<T>& p, T r, T half_length) {
  const Vec3T<T> q{p.x, p.y - std::clamp(p.y, -half_length, half_length), p.z};
  const T l = norm(q);
  return {l - r, l > 0 ? q / l : Vec3T<T>{1, 0, 0}};
}

/// Box of half extents `half`; on a tie inside, the first of x, y, z gives the normal.
template <class T>
SurfaceDistance<T> box_distance(const Vec3T<T>& p, const Vec3T<T>& half) {
  const auto sign = [](T v) { return v < 0 ? T(-1) : T(1); };
  const Vec3T<T> q{std::fabs(p.x) - half.x, std::fabs(p.y) - half.y, std::fabs(p.z) - half.z};
  const Vec3T<T> s{sign(p.x), sign(p.y), sign(p.z)};
  if (q.x <= 0 && q.y <= 0 && q.z <= 0) {
    if (q.x >= q.y && q.x >= q.z) return {q.x, {s.x, 0, 0}};
    if (q.y >= q.z) return {q.y, {0, s.y, 0}};
    return {q.z, {0, 0, s.z}};
  }
  const Vec3T<T> o{q.x > 0 ? q.x : 0, q.y > 0 ? q.y : 0, q.z > 0 ? q.z : 0};
  const T l = norm(o);
  return {l, {s.x * o.x / l, s.y * o.y / l, s.z * o.z / l}};
}

}  // namespace truestep
