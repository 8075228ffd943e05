// First contact of two balls whose distance vector follows a cubic over a step: the Bezier form of the cubic
// through both ends with their velocities (Hermite). A curve lies in the hull of its control points, so a
// part whose hull stays beyond reach is done with; what is left is halved until it is straight.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep {

/// Control points of the cubic from d0 to d1 with end slopes u0, u1 (m per whole step).
struct CubicPath {
  std::array<Vec3, 4> p;
  static CubicPath through(const Vec3& d0, const Vec3& u0, const Vec3& d1, const Vec3& u1) {
    return {{d0, d0 + u0 * (1.0 / 3), d1 - u1 * (1.0 / 3), d1}};
  }
  Vec3 at(double s) const {
    const double q = 1 - s;
    return p[0] * (q * q * q) + p[1] * (3 * q * q * s) + p[2] * (3 * q * s * s) + p[3] * (s * s * s);
  }
  /// m per whole step.
  Vec3 slope(double s) const {
    const double q = 1 - s;
    return ((p[1] - p[0]) * (q * q) + (p[2] - p[1]) * (2 * q * s) + (p[3] - p[2]) * (s * s)) * 3;
  }
  /// Largest distance (m) of the hull from its start.
  double spread() const {
    return std::sqrt(std::max({norm2(p[1] - p[0]), norm2(p[2] - p[0]), norm2(p[3] - p[0])}));
  }
  /// Whether it may come within `reach` (m) of the origin; true only in doubt.
  bool may_reach(double reach) const {
    const double far = norm(p[0]) - reach;
    return !(far > 0) || !(spread() < far);
  }
};

/// Fraction of a straight way from d0 to d1 at which its length falls to `reach` (m): 0 if it is less at the
/// start and falling; 2 for never.
inline double first_contact_on_line(const Vec3& d0, const Vec3& d1, double reach) {
  const Vec3 u = d1 - d0;
  const double b = dot(d0, u), c = norm2(d0) - reach * reach, a = norm2(u);
  if (b >= 0) return 2;
  if (c <= 0) return 0;
  const double root = b * b - a * c;
  if (root < 0) return 2;
  const double share = c / (-b + std::sqrt(root));
  return share <= 1 ? share : 2;
}

/// The same for a cubic.
inline double first_contact_on_cubic(const CubicPath& path, double reach) {
  constexpr int kDepth = 24;
  constexpr double kStraight = 1e-6;  // of the reach
  struct Part {
    CubicPath path;
    double from, length;
    int depth;
  };
  std::array<Part, kDepth + 2> open;
  size_t count = 1;
  open[0] = {path, 0, 1, 0};
  while (count > 0) {
    const Part part = open[--count];
    const auto& p = part.path.p;
    if (!part.path.may_reach(reach)) continue;
    const Vec3 bend = p[1] * 3 - p[0] * 2 - p[3], other = p[2] * 3 - p[0] - p[3] * 2;
    if (part.depth == kDepth ||
        std::max(norm2(bend), norm2(other)) <= kStraight * kStraight * reach * reach) {
      const double share = first_contact_on_line(p[0], p[3], reach);
      if (share <= 1) return part.from + share * part.length;
      continue;
    }
    const Vec3 a = (p[0] + p[1]) * 0.5, b = (p[1] + p[2]) * 0.5, c = (p[2] + p[3]) * 0.5;
    const Vec3 ab = (a + b) * 0.5, bc = (b + c) * 0.5, middle = (ab + bc) * 0.5;
    const double half = 0.5 * part.length;
    // The earlier half is looked at first.
    open[count++] = {{{middle, bc, c, p[3]}}, part.from + half, half, part.depth + 1};
    open[count++] = {{{p[0], a, ab, middle}}, part.from, half, part.depth + 1};
  }
  return 2;
}

}  // namespace truestep
