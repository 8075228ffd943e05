// A moving point against the moving convex hull of one to three corners: the centre of a ball, the axis of a
// capsule, a triangle. The nearest point on a triangle by its Voronoi regions (Ericson 2005, "Real-Time
// Collision Detection", section 5.1.5), given as barycentric weights. First contact by directional
// advancement: along the direction n of the present shortest distance, the separation n.(p - c_i) of every
// corner is a quadratic in time, and until the first of them reaches the target the point stays clear; for a
// flat triangle or a straight approach one advance arrives, however thin the hull or fast the point.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/math/vec3.h"

namespace truestep {

/// Weights of the corners: non-negative, with sum 1.
using HullWeights = std::array<double, 3>;

inline HullWeights nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double l2 = norm2(ab), t = l2 > 0 ? dot(p - a, ab) / l2 : 0;
  const double s = t < 0 ? 0 : t > 1 ? 1 : t;
  return {1 - s, s, 0};
}

inline HullWeights nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return nearest_on_segment(p, a, b);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const HullWeights w = nearest_on_segment(p, a, c);
    return {w[0], 0, w[1]};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const HullWeights w = nearest_on_segment(p, b, c);
    return {0, w[0], w[1]};
  }
  const double sum = va + vb + vc;
  // A triangle without area: one of its edges holds the nearest point.
  if (!(sum > 0)) return nearest_on_segment(p, a, b);
  const double v = vb / sum, w = vc / sum;
  return {1 - v - w, v, w};
}

inline HullWeights nearest_on_hull(const Vec3& p, const std::array<Vec3, 3>& c, size_t corners) {
  if (corners == 3) return nearest_on_triangle(p, c[0], c[1], c[2]);
  if (corners == 2) return nearest_on_segment(p, c[0], c[1]);
  return {1, 0, 0};
}

inline Vec3 blend(const std::array<Vec3, 3>& c, const HullWeights& w, size_t corners) {
  Vec3 sum = c[0] * w[0];
  for (size_t i = 1; i < corners; ++i) sum += c[i] * w[i];
  return sum;
}

/// x(s) = x + v s + a s^2 / 2 for s in [0, 1].
struct HullPath {
  Vec3 x, v, a;
  Vec3 at(double s) const { return x + (v + a * (0.5 * s)) * s; }
};

struct HullContact {
  double s = 0;      ///< fraction of the step
  HullWeights w{};   ///< of the corners
  Vec3 n;            ///< unit, from the hull to the point
  double apart = 0;  ///< m, distance from the hull itself
};

inline constexpr int kHullAdvances = 60;

/// Nearest point, distance and direction at one moment. A point on the hull itself gets the triangle's normal
/// on the side that `from` (a velocity relative to the hull) comes from.
inline HullContact hull_distance(const Vec3& p, const std::array<Vec3, 3>& c, size_t corners,
                                 const Vec3& from) {
  HullContact h;
  h.w = nearest_on_hull(p, c, corners);
  const Vec3 r = p - blend(c, h.w, corners);
  h.apart = norm(r);
  if (corners == 3 && h.w[0] > 0 && h.w[1] > 0 && h.w[2] > 0) {
    // Over the face the direction is the face normal, however short r is.
    const Vec3 n = normalized(cross(c[1] - c[0], c[2] - c[0]), {0, 1, 0});
    const double side = h.apart > 0 ? dot(n, r) : -dot(n, from);
    h.n = side < 0 ? -n : n;
  } else {
    h.n = h.apart > 0 ? r / h.apart : normalized(-from, {0, 1, 0});
  }
  return h;
}

/// Whether a point certainly stays farther than `target` (m) from a triangle over s in [start, 1]: no corner
/// comes near along the triangle's normal at the start. A cheap test; false is inconclusive.
inline bool stays_clear(const HullPath& p, const std::array<HullPath, 3>& c, double target,
                        double start = 0) {
  const Vec3 a = c[0].at(start), n = cross(c[1].at(start) - a, c[2].at(start) - a), end = p.at(1);
  const double level = dot(n, p.at(start) - a), side = level < 0 ? -1 : 1;
  const double rest = 1 - start, bend = 0.125 * rest * rest;
  // A parabola departs from its chord by an eighth of its acceleration.
  double least = side * level;
  for (const HullPath& q : c) {
    const double chord = std::min(side * level, side * dot(n, end - q.at(1)));
    least = std::min(least, chord - bend * std::fabs(dot(n, p.a - q.a)));
  }
  return least > 0 && least * least > target * target * norm2(n);
}

/// First moment from `start` on at which the point comes within `target` (m) of the hull; empty if it does
/// not. A point within `target` at the start counts there. A hull that rotates fast may need more advances
/// than are made and is then reported as missed: kernels/contact/straight_contact.h finds those.
inline std::optional<HullContact> first_hull_contact(const HullPath& p, const std::array<HullPath, 3>& c,
                                                     size_t corners, double target, double start = 0) {
  // Near the end of the path the point counts as arrived: rounding must not keep it from touching.
  const double arrived = target + 1e-3 * target + 1e-12;
  double s = start;
  for (int i = 0; i < kHullAdvances; ++i) {
    std::array<Vec3, 3> at;
    for (size_t k = 0; k < corners; ++k) at[k] = c[k].at(s);
    HullContact h = hull_distance(p.at(s), at, corners, p.v - c[0].v);
    h.s = s;
    if (h.apart <= (s > start ? arrived : target)) return h;
    double advance = 2;
    for (size_t k = 0; k < corners; ++k) {
      const HullPath& q = c[k];
      const double a = 0.5 * dot(h.n, p.a - q.a), b = dot(h.n, p.v + p.a * s - q.v - q.a * s);
      // No corner is nearer than the hull, except by rounding; a negative room would advance backwards.
      const double room = std::max(dot(h.n, p.at(s) - q.at(s)), h.apart) - target;
      const double discriminant = b * b - 4 * a * room;
      if (discriminant < 0) continue;
      // The later root, for a point that leaves and returns; each in the form without cancellation.
      const double root = std::sqrt(discriminant);
      if (b < 0) {
        advance = std::min(advance, 2 * room / (root - b));
      } else if (a < 0) {
        advance = std::min(advance, (b + root) / (-2 * a));
      }
    }
    s += advance;
    if (s > 1) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace truestep
