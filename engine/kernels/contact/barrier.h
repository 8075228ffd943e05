// Potentials of contact and friction that an optimizer can differentiate (Li, Ferguson, Schneider, Langlois,
// Zorin, Panozzo, Jiang, Kaufman 2020, "Incremental potential contact").
#pragma once
#include <array>

#include "engine/kernels/contact/proximity.h"
#include "engine/math/trig.h"

namespace truestep::barrier {

/// Value and first two derivatives of a function of one variable.
struct Slope2 {
  double value = 0, first = 0, second = 0;
};

/// b(d) = -(d - r)^2 ln(d / r) in m^2: infinite at a gap d of 0, zero for d >= r, and twice continuously
/// differentiable there (their equation 6). d and r are positive.
inline Slope2 log_barrier(double d, double r) {
  if (d >= r) return {};
  const double ln = trig::log(d / r), s = d - r;
  return {-s * s * ln, -2 * s * ln - s * s / d, -2 * ln - 4 * s / d + s * s / (d * d)};
}

/// Factor of the barrier between two segments that keeps its gradient continuous where they become parallel
/// and the closest points are no longer unique: m = (2 - c / e) c / e for c = |u x v|^2 below e (their
/// equation 22). Derivatives with respect to the end points p0 p1 q0 q1.
struct Mollifier {
  double value = 1, by_c = 0;  ///< m and dm/dc
  std::array<Vec3, 4> slope{};
};
/// `e` in m^4: a thousandth of the product of the squared rest lengths.
inline Mollifier mollifier(const FeaturePoints& x, double e) {
  const Vec3 u = x[1] - x[0], v = x[3] - x[2];
  const double uu = norm2(u), vv = norm2(v), uv = dot(u, v), c = norm2(cross(u, v));
  if (c >= e) return {};
  const double m = (2 - c / e) * c / e, dm = 2 * (1 - c / e) / e;
  const Vec3 by_u = (vv * u - uv * v) * (2 * dm), by_v = (uu * v - uv * u) * (2 * dm);
  return {m, dm, {-by_u, by_u, -by_v, by_v}};
}

/// f0(y) with f0' = f1: Coulomb friction over a slip y (m), smoothed below `still` (m), where the force grows
/// with the slip (their section 5.4). `first` is f1(y) / y, which stays finite at 0; `second` is f1'(y).
inline Slope2 smooth_slip(double y, double still) {
  if (y >= still) return {y, 1 / y, 0};
  const double q = y / still;
  return {y * q * (1 - q / 3) + still / 3, (2 - q) / still, 2 * (1 - q) / still};
}

}  // namespace truestep::barrier
