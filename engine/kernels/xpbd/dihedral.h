// Angle between two triangles about the edge x0 x1, opposite corners x2 and x3:
//   C = theta - theta_0,   E = 1/2 C^2 / alpha,   alpha = (A0 + A1) / (|e|^2 D)
// (Grinspun, Hirani, Desbrun, Schroeder 2003, "Discrete shells", with the hinge weight of linear.h, so that
// both agree at small angles; gradient as in Bridson, Marino, Fedkiw 2003, section 4, without its arccos).
// For sheets that are not flat at rest. theta is 0 for coplanar triangles on opposite sides of the edge, and
// positive if x2 and x3 bend towards (x1 - x0) x (x2 - x0).
#pragma once
#include <array>
#include <cmath>

#include "engine/kernels/xpbd/compliance.h"
#include "engine/math/trig.h"
#include "engine/math/vec3.h"

namespace truestep::xpbd {

/// Angle in (-pi, pi] and its gradients (1/m); all zero if a triangle has no area.
struct Dihedral {
  double angle = 0;
  std::array<Vec3, 4> slope{};
};
inline Dihedral dihedral(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3) {
  const Vec3 e = x1 - x0, n0 = cross(e, x2 - x0), n1 = cross(x3 - x0, e);
  const double l2 = norm2(e), a2 = norm2(n0), b2 = norm2(n1);
  if (!(l2 > 0) || !(a2 > 0) || !(b2 > 0)) return {};
  const double l = std::sqrt(l2);
  Dihedral out;
  out.angle = trig::atan2(dot(cross(n0, n1), e) / -l, dot(n0, n1));
  const Vec3 to2 = n0 * (l / a2), to3 = n1 * (l / b2);
  const double s2 = dot(x2 - x0, e) / l2, s3 = dot(x3 - x0, e) / l2;
  out.slope = {-((1 - s2) * to2 + (1 - s3) * to3), -(s2 * to2 + s3 * to3), to2, to3};
  return out;
}

/// Difference of two angles, in (-pi, pi].
inline double turned(double angle, double rest) {
  constexpr double kPi = 3.14159265358979323846;
  const double d = angle - rest;
  return d > kPi ? d - 2 * kPi : d <= -kPi ? d + 2 * kPi : d;
}

/// Moves the four rows (x, y, z, inverse mass) by `relax` times the correction; adds to lambda. `base` (n x
/// 3): the positions at which rows are 0.
template <class T>
void solve_dihedral(const std::array<uint32_t, 4>& points, double rest, const Softness<double>& s, T relax,
                    const double* base, T* rows, double& lambda) {
  const auto place = [&](size_t i) {
    const T* r = rows + 4 * size_t{points[i]};
    return load3(base, points[i]) + Vec3{r[0], r[1], r[2]};
  };
  const Dihedral d = dihedral(place(0), place(1), place(2), place(3));
  double weight = 0;
  for (size_t i = 0; i < 4; ++i) weight += rows[4 * size_t{points[i]} + 3] * norm2(d.slope[i]);
  const double step = multiplier_step(turned(d.angle, rest), lambda, 0.0, weight, s);
  lambda += step;
  for (size_t i = 0; i < 4; ++i) {
    T* r = rows + 4 * size_t{points[i]};
    const Vec3 by = d.slope[i] * (double{r[3]} * step * relax);
    r[0] = static_cast<T>(r[0] + by.x), r[1] = static_cast<T>(r[1] + by.y),
    r[2] = static_cast<T>(r[2] + by.z);
  }
}

}  // namespace truestep::xpbd
