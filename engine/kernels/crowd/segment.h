// Straight pieces in the plane z = 0: nearest points, crossings, distances. Lengths in m.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep::crowd {

struct Segment {
  Vec3 a, b;
};

inline double cross2(const Vec3& a, const Vec3& b) {
  return a.x * b.y - a.y * b.x;
}

/// Fraction of the path from a to b at which the segment is nearest to x; 0 if it has no length.
inline double nearest_share(const Segment& s, const Vec3& x) {
  const Vec3 d = s.b - s.a;
  const double l2 = norm2(d);
  return l2 > 0 ? std::clamp(dot(x - s.a, d) / l2, 0.0, 1.0) : 0.0;
}
inline Vec3 nearest_point(const Segment& s, const Vec3& x) {
  return s.a + (s.b - s.a) * nearest_share(s, x);
}

/// Direction in which the path from p.a to p.b crosses q: 1 from the right of q (seen from q.a to q.b) to its
/// left, -1 the other way, 0 not at all. A path that starts on q crosses it, one that ends there does not
/// yet.
inline int crossing(const Segment& p, const Segment& q) {
  const Vec3 d = q.b - q.a;
  const double from = cross2(d, p.a - q.a), to = cross2(d, p.b - q.a);
  if (!((from <= 0 && to > 0) || (from >= 0 && to < 0))) return 0;
  const Vec3 at = p.a + (p.b - p.a) * (from / (from - to));
  const double share = dot(at - q.a, d);
  return share >= 0 && share <= norm2(d) ? (to > 0 ? 1 : -1) : 0;
}

/// Whether the path from p.a to p.b ends on q or beyond it. One that starts on q is free to leave to either
/// side.
inline bool runs_into(const Segment& p, const Segment& q) {
  const Vec3 d = q.b - q.a;
  const double from = cross2(d, p.a - q.a), to = cross2(d, p.b - q.a);
  if (!((from < 0 && to >= 0) || (from > 0 && to <= 0))) return false;
  const double share = dot(p.a + (p.b - p.a) * (from / (from - to)) - q.a, d);
  return share >= 0 && share <= norm2(d);
}

/// Shortest distance between two segments; 0 if they cross.
inline double segment_distance(const Segment& p, const Segment& q) {
  if (crossing(p, q) != 0) return 0;
  return std::min({norm(p.a - nearest_point(q, p.a)), norm(p.b - nearest_point(q, p.b)),
                   norm(q.a - nearest_point(p, q.a)), norm(q.b - nearest_point(p, q.b))});
}

}  // namespace truestep::crowd
