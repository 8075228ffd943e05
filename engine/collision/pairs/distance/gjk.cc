#include "engine/collision/pairs/distance/gjk.h"

#include <algorithm>

namespace truestep {
namespace {

/// Weights of the point nearest to the origin, and which vertices it needs.
struct Nearest {
  Vec3 point;
  double weight[4];
  int keep[4];
  int count = 0;
};

Nearest of_point(const Simplex& s, int i) {
  return {s.w[i], {1}, {i}, 1};
}

Nearest of_segment(const Simplex& s, int i, int j) {
  const Vec3 &p = s.w[i], d = s.w[j] - p;
  const double l2 = norm2(d), t = -dot(p, d);
  if (!(t > 0)) return of_point(s, i);
  if (!(t < l2)) return of_point(s, j);
  // From the nearer end, for accuracy.
  const double u = t / l2;
  const Vec3 q = u < 0.5 ? p + d * u : s.w[j] - d * (1 - u);
  return {q, {1 - u, u}, {i, j}, 2};
}

Nearest nearer(const Nearest& a, const Nearest& b) {
  return norm2(b.point) < norm2(a.point) ? b : a;
}

Nearest of_triangle(const Simplex& s, int i, int j, int k) {
  const Vec3 &a = s.w[i], &b = s.w[j], &c = s.w[k];
  const Vec3 n = cross(b - a, c - a);
  const double n2 = norm2(n);
  // Barycentric weights of the origin's projection.
  const double u = dot(n, cross(b, c)), v = dot(n, cross(c, a)), w = dot(n, cross(a, b));
  if (n2 > 0 && u > 0 && v > 0 && w > 0) {
    const double sum = u + v + w;
    return {n * (dot(n, a) / n2), {u / sum, v / sum, w / sum}, {i, j, k}, 3};
  }
  Nearest best = of_segment(s, i, j);
  best = nearer(best, of_segment(s, j, k));
  return nearer(best, of_segment(s, k, i));
}

Nearest on_faces(const Simplex& s) {
  return nearer(nearer(of_triangle(s, 1, 2, 3), of_triangle(s, 0, 2, 3)),
                nearer(of_triangle(s, 0, 1, 3), of_triangle(s, 0, 1, 2)));
}

/// The origin is inside when it lies on the same side of every face as the fourth point.
bool holds_origin(const Simplex& s) {
  const auto same_side = [&](int i, int j, int k, int l) {
    const Vec3 n = cross(s.w[j] - s.w[i], s.w[k] - s.w[i]);
    return -dot(n, s.w[i]) * dot(n, s.w[l] - s.w[i]) > 0;
  };
  return same_side(1, 2, 3, 0) && same_side(0, 2, 3, 1) && same_side(0, 1, 3, 2) && same_side(0, 1, 2, 3);
}

/// `clear`: a plane with the origin on its far side is known, so the signs of a flat tetrahedron do not
/// count.
enum class Known : uint8_t { nothing, clear };
Nearest nearest(const Simplex& s, Known known) {
  switch (s.count) {
    case 1:
      return of_point(s, 0);
    case 2:
      return of_segment(s, 0, 1);
    case 3:
      return of_triangle(s, 0, 1, 2);
    default:
      if (known == Known::nothing && holds_origin(s)) return {{}, {0.25, 0.25, 0.25, 0.25}, {0, 1, 2, 3}, 4};
      return on_faces(s);
  }
}

void reduce(Simplex& s, const Nearest& n) {
  Simplex r;
  for (int k = 0; k < n.count; ++k) {
    r.w[k] = s.w[n.keep[k]], r.a[k] = s.a[n.keep[k]], r.b[k] = s.b[n.keep[k]];
    r.weight[k] = n.weight[k];
  }
  r.count = n.count;
  s = r;
}

}  // namespace

CoreDistance core_distance(const Convex& a, const Convex& b, const Transform& b_in_a, const Vec3& seed,
                           double enough) {
  CoreDistance out;
  Simplex& s = out.simplex;
  Vec3 v = norm2(seed) > 0 ? -seed : Vec3{1, 0, 0};
  double length2 = std::numeric_limits<double>::infinity(), scale2 = 0;
  const auto finish = [&](CoreDistance::Verdict verdict) {
    out.point_a = out.point_b = {};
    for (int k = 0; k < s.count; ++k)
      out.point_a += s.a[k] * s.weight[k], out.point_b += s.b[k] * s.weight[k];
    out.verdict = verdict;
    out.distance = verdict == CoreDistance::Verdict::separate ? norm(v) : 0;
    out.normal = normalized(-v);
    return out;
  };
  for (int round = 0; round < 128; ++round) {
    const Vec3 pa = a.support(-v), pb = b_in_a.point(b.support(b_in_a.inverse_direction(v)));
    const Vec3 w = pa - pb;
    const double along = dot(v, w);
    // All of the difference set lies beyond the plane through w.
    if (round > 0) {
      if (enough >= 0 && along > 0 && along * along > enough * enough * length2) {
        return finish(CoreDistance::Verdict::separate);
      }
      if (length2 - along <= 1e-12 * length2) return finish(CoreDistance::Verdict::separate);
      for (int k = 0; k < s.count; ++k) {
        if (s.w[k] == w) return finish(CoreDistance::Verdict::separate);
      }
    }
    const Simplex before = s;
    s.w[s.count] = w, s.a[s.count] = pa, s.b[s.count] = pb;
    ++s.count;
    scale2 = std::max({scale2, norm2(pa), norm2(pb)});
    const Nearest n = nearest(s, along > 0 ? Known::clear : Known::nothing);
    const double better2 = norm2(n.point);
    if (n.count == 4 || better2 <= 1e-28 * scale2) {
      reduce(s, n);
      v = n.point;
      return finish(CoreDistance::Verdict::overlap);
    }
    if (!(better2 < length2)) {
      s = before;
      return finish(CoreDistance::Verdict::separate);
    }
    reduce(s, n);
    v = n.point;
    length2 = better2;
  }
  return finish(CoreDistance::Verdict::separate);
}

}  // namespace truestep
