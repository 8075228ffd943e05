// The forces on bodies in a close encounter besides the sun's, for mercurius.h, and how such pairs are
// detected.
//   x_i'' = -mu x_i/|x_i|^3 - sum_j (1 - L(r_ij)) G m_j (x_i - x_j)/(r_ij^2 + eps^2)^(3/2)
//   L(y) = 10 y^3 - 15 y^4 + 6 y^5,   y = (r - 0.1 R)/(0.9 R) between 0 and 1   (Rein et al. 2019, eq. 11)
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/core/equations/right_hand_side.h"
#include "engine/math/vec3.h"

namespace truestep::nbody {

/// L: the fraction of a pair's force that is applied as a kick. r, radius in m.
inline double changeover(double r, double radius) {
  const double y = (r - 0.1 * radius) / (0.9 * radius);
  if (!(y > 0)) return 0;
  return y >= 1 ? 1 : y * y * y * (10 - y * (15 - 6 * y));
}

/// Smallest distance (m) from the origin to the cubic from d0 with slope u0 to d1 with slope u1, slopes times
/// the step's length; approximated by sixteen chords.
inline double closest_on_cubic(const Vec3& d0, const Vec3& u0, const Vec3& d1, const Vec3& u1) {
  constexpr int kChords = 16;
  double least2 = norm2(d0);
  Vec3 from = d0;
  for (int k = 1; k <= kChords; ++k) {
    const double s = static_cast<double>(k) / kChords, p = 1 - s;
    const Vec3 to =
        d0 * (p * p * (1 + 2 * s)) + u0 * (p * p * s) + d1 * (s * s * (3 - 2 * s)) - u1 * (s * s * p);
    const Vec3 along = to - from;
    const double l2 = norm2(along), w = l2 > 0 ? std::clamp(-dot(from, along) / l2, 0.0, 1.0) : 0;
    least2 = std::min(least2, norm2(from + along * w));
    from = to;
  }
  return std::sqrt(least2);
}

/// Motion of the bodies in an encounter, about the sun at the origin.
class Encounter final : public RightHandSide, public SecondOrder {
 public:
  double sun = 0, eps2 = 0;       ///< G m_0 (m^3/s^2), softening squared (m^2)
  std::vector<double> mu, reach;  ///< of each: G m (m^3/s^2), changeover radius (m)
  std::vector<double> y;          ///< positions, then velocities

  size_t size() const override { return 6 * mu.size(); }
  const SecondOrder* second_order() const override { return this; }
  bool autonomous() const override { return true; }
  bool depends_on_velocity() const override { return false; }
  std::string name_of(size_t i) const override {
    return "coordinate " + std::to_string(i) + " in a close encounter";
  }
  void rate(double t, const double* y, double* dydt) const override {
    const size_t half = size() / 2;
    std::copy_n(y + half, half, dydt);
    acceleration(t, y, nullptr, dydt + half);
  }
  void acceleration(double, const double* x, const double*, double* a) const override {
    const size_t n = mu.size();
    for (size_t i = 0; i < n; ++i) {
      const Vec3 xi = load3(x, i);
      const double r2 = norm2(xi);
      store3(a, i, r2 > 0 ? xi * (-sun / (r2 * std::sqrt(r2))) : Vec3{});
    }
    for (size_t i = 0; i < n; ++i) {
      for (size_t j = i + 1; j < n; ++j) {
        const Vec3 d = load3(x, j) - load3(x, i);
        const double r2 = norm2(d), soft2 = r2 + eps2;
        if (!(soft2 > 0)) continue;
        const double w =
            (1 - changeover(std::sqrt(r2), std::max(reach[i], reach[j]))) / (soft2 * std::sqrt(soft2));
        store3(a, i, load3(a, i) + d * (w * mu[j]));
        store3(a, j, load3(a, j) - d * (w * mu[i]));
      }
    }
  }
};

}  // namespace truestep::nbody
