// Distance between two features of a surface (a point and a triangle, or two segments), and the time at which
// they first come within a distance of each other along straight paths:
//   separation s = sum_i c_i x_i,   distance = |s|,   normal = s / |s|, towards the first feature,
// with the weights c of the closest points (Ericson 2004, "Real-time collision detection", sections 5.1.5 and
// 5.1.9). The time is found by conservative advancement with the common motion removed (Li, Kaufman, Jiang
// 2021, "Codimensional incremental potential contact", section 5): a step never exceeds the remaining
// distance over the largest speed at which it can shrink, so that no contact is stepped over.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/math/vec3.h"

namespace truestep {

/// Positions or displacements of the points of both features: p a b c of a point and a triangle, p0 p1 q0 q1
/// of two segments.
using FeaturePoints = std::array<Vec3, 4>;

struct Proximity {
  double distance = 0;        ///< m
  Vec3 normal;                ///< unit; zero if the features meet
  std::array<double, 4> c{};  ///< weights of the closest points: sum 0
};

inline Proximity proximity_of(const FeaturePoints& x, const std::array<double, 4>& c) {
  const Vec3 s = x[0] * c[0] + x[1] * c[1] + x[2] * c[2] + x[3] * c[3];
  const double d = norm(s);
  return {d, d > 0 ? s / d : Vec3{}, c};
}

struct PointTriangle {
  static constexpr size_t kFirst = 1;  ///< number of points of the first feature
  static Proximity closest(const FeaturePoints& x) {
    const Vec3 ab = x[2] - x[1], ac = x[3] - x[1], ap = x[0] - x[1];
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return proximity_of(x, {1, -1, 0, 0});
    const Vec3 bp = x[0] - x[2];
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return proximity_of(x, {1, 0, -1, 0});
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
      const double v = d1 / (d1 - d3);
      return proximity_of(x, {1, v - 1, -v, 0});
    }
    const Vec3 cp = x[0] - x[3];
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return proximity_of(x, {1, 0, 0, -1});
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
      const double w = d2 / (d2 - d6);
      return proximity_of(x, {1, w - 1, 0, -w});
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
      const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
      return proximity_of(x, {1, 0, w - 1, -w});
    }
    const double inverse = 1 / (va + vb + vc), v = vb * inverse, w = vc * inverse;
    return proximity_of(x, {1, v + w - 1, -v, -w});
  }
};

struct SegmentSegment {
  static constexpr size_t kFirst = 2;
  static Proximity closest(const FeaturePoints& x) {
    const Vec3 d1 = x[1] - x[0], d2 = x[3] - x[2], r = x[0] - x[2];
    const double a = norm2(d1), e = norm2(d2), f = dot(d2, r), c = dot(d1, r), b = dot(d1, d2);
    const auto share = [](double t) { return std::clamp(t, 0.0, 1.0); };
    double s = 0, t = 0;
    if (a > 0 && e > 0) {
      const double denominator = a * e - b * b;
      // Parallel segments have no unique closest points: start from the first end.
      s = denominator > 1e-12 * a * e ? share((b * f - c * e) / denominator) : 0;
      t = (b * s + f) / e;
      if (t < 0) {
        t = 0, s = share(-c / a);
      } else if (t > 1) {
        t = 1, s = share((b - c) / a);
      }
    } else if (a > 0) {
      s = share(-c / a);
    } else if (e > 0) {
      t = share(f / e);
    }
    return proximity_of(x, {1 - s, s, t - 1, -t});
  }
};

struct Approach {
  double t;  ///< fraction of the path
  Proximity at;
};

/// A t in [0, 1] at which features with initial proximity `start` that move by dx are within `target` (m,
/// above 0), before they come within four fifths of it; empty if they never do.
template <class Kind>
std::optional<Approach> first_approach(const FeaturePoints& x, FeaturePoints dx, double target,
                                       const Proximity& start) {
  if (start.distance <= target) return Approach{0, start};
  const Vec3 mean = (dx[0] + dx[1] + dx[2] + dx[3]) * 0.25;
  double first = 0, second = 0;
  for (size_t i = 0; i < 4; ++i) {
    dx[i] -= mean;
    double& most = i < Kind::kFirst ? first : second;
    most = std::max(most, norm2(dx[i]));
  }
  const double speed = std::sqrt(first) + std::sqrt(second);
  if (start.distance - target >= speed) return std::nullopt;
  constexpr int kMostSteps = 1000;
  double t = 0, distance = start.distance;
  for (int k = 0;; ++k) {
    t += (distance - 0.8 * target) / speed;
    if (!(t < 1)) return std::nullopt;
    FeaturePoints there;
    for (size_t i = 0; i < 4; ++i) there[i] = x[i] + dx[i] * t;
    const Proximity at = Kind::closest(there);
    if (at.distance <= target || k == kMostSteps) return Approach{t, at};
    distance = at.distance;
  }
}

}  // namespace truestep
