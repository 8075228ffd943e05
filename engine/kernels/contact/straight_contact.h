// First contact of a point with a triangle whose corners all move along straight lines, for thin cloth that
// rotates fast. The advancement of kernels/contact/point_hull.h keeps one direction, along which a rotating
// triangle comes close long before it touches; here the distance from the triangle's own plane counts as
// well:
//   L(s) = (e1(s) x e2(s)) . (p(s) - c(s)),  a cubic (Provot 1997, "Collision and self-collision handling in
//          cloth model dedicated to design garments", eq. 2),
// and until |L| falls to target * max |e1 x e2| the point is clear. Both bounds are safe, so nothing is
// missed; a pair that makes no further progress counts as meeting.
#pragma once
#include "engine/kernels/contact/point_hull.h"

namespace truestep {

/// Smallest t in (0, end] at which c0 + c1 t + c2 t^2 + c3 t^3 (c0 > 0) falls to 0, rounded down so that the
/// polynomial is still positive there; a value above `end` if there is none.
inline double first_fall_of_cubic(double c0, double c1, double c2, double c3, double end) {
  const auto value = [&](double t) { return c0 + t * (c1 + t * (c2 + t * c3)); };
  // Between its extrema the cubic is monotone.
  double knots[3] = {end, end, end};
  const double a = 3 * c3, b = c2, discriminant = b * b - a * c1;
  if (discriminant > 0) {
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    const double r1 = a != 0 ? q / a : -1, r2 = q != 0 ? c1 / q : -1;
    const double first = std::min(r1, r2), second = std::max(r1, r2);
    if (first > 0 && first < end) knots[0] = first;
    if (second > 0 && second < end) (knots[0] < end ? knots[1] : knots[0]) = second;
  }
  double low = 0;
  for (double high : knots) {
    if (high <= low) continue;
    if (value(high) > 0) {
      low = high;
      continue;
    }
    for (int i = 0; i < 50 && high - low > 1e-14 * end; ++i) {
      const double middle = 0.5 * (low + high);
      (value(middle) > 0 ? low : high) = middle;
    }
    return low;
  }
  return 2 * end + 1;
}

/// How long from now (as a fraction of the step) the point certainly stays farther than `target` from the
/// plane of the triangle: x, v of the point and c, w of the corners at this moment, over at most `rest`.
inline double clear_of_plane(const Vec3& x, const Vec3& v, const std::array<Vec3, 3>& c,
                             const std::array<Vec3, 3>& w, double target, double rest) {
  const Vec3 e1 = c[1] - c[0], e2 = c[2] - c[0], f1 = w[1] - w[0], f2 = w[2] - w[0], r = x - c[0],
             u = v - w[0];
  const Vec3 n0 = cross(e1, e2), n1 = cross(e1, f2) + cross(f1, e2), n2 = cross(f1, f2);
  const double l0 = dot(n0, r), side = l0 < 0 ? -1 : 1;
  const double widest = norm(n0) + rest * (norm(n1) + rest * norm(n2));
  const double room = side * l0 - target * widest;
  if (!(room > 0)) return 0;
  return first_fall_of_cubic(room, side * (dot(n1, r) + dot(n0, u)), side * (dot(n2, r) + dot(n1, u)),
                             side * dot(n2, u), rest);
}

inline constexpr int kStraightAdvances = 60;

/// First moment at which the point comes within twice `target` (m) on straight paths (accelerations are
/// ignored); empty if it stays farther than `target`. It must be farther than that at the start.
inline std::optional<HullContact> first_straight_contact(const HullPath& p, const std::array<HullPath, 3>& c,
                                                         double target) {
  double s = 0;
  const std::array<Vec3, 3> w{c[0].v, c[1].v, c[2].v};
  HullContact h;
  for (int i = 0; i < kStraightAdvances; ++i) {
    std::array<Vec3, 3> at;
    for (size_t k = 0; k < 3; ++k) at[k] = c[k].x + w[k] * s;
    const Vec3 x = p.x + p.v * s;
    h = hull_distance(x, at, 3, p.v - w[0]);
    h.s = s;
    if (h.apart <= 2 * target) return h;
    double along = 2;
    for (size_t k = 0; k < 3; ++k) {
      const double closing = -dot(h.n, p.v - w[k]);
      if (closing > 0) along = std::min(along, (dot(h.n, x - at[k]) - target) / closing);
    }
    const double advance =
        s + along > 1 ? along : std::max(along, clear_of_plane(x, p.v, at, w, target, 1 - s));
    s += advance;
    if (s > 1) return std::nullopt;
  }
  return h;
}

}  // namespace truestep
