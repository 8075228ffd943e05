// What a wall adds to the sums of a particle beside it: integrals of the smoothing kernel over the half space
// behind the wall, by the distance d (m) of the particle (after the volume maps of Bender et al. 2019, for
// walls that are flat over a kernel's width). Tables with 512 intervals over d in [-H, H], linear between.
#pragma once
#include <array>
#include <cmath>

#include "engine/kernels/sph/smoothing.h"

namespace truestep::sph {

struct HalfSpace {
  static constexpr int kIntervals = 512;
  double support = 1;                        ///< m, H
  std::array<double, kIntervals + 1> share;  ///< 1, of the kernel that lies behind the wall
  std::array<double, kIntervals + 1> slope;  ///< 1/m, -d share / d d: the kernel's integral over the plane
  std::array<double, kIntervals + 1> shear;  ///< 1/m, integral of -2 z dW/dr / r over z > d, see below

  /// Sets the tables for a kernel.
  void set(Smoothing kind, int dimension, double radius) {
    support = radius;
    const double sigma = smoothing_sigma(kind, dimension);
    constexpr double kPi = 3.14159265358979323846;
    constexpr int kRings = 512;
    std::array<double, kIntervals + 1> moment;
    for (int i = 0; i <= kIntervals; ++i) {
      const double z = 2.0 * i / kIntervals - 1, most = std::sqrt(std::max(0.0, 1 - z * z));
      double w = 0, s = 0;
      for (int k = 0; k < kRings; ++k) {
        const double a = (k + 0.5) / kRings * most;
        const SmoothingValue<double> v = smoothing_at(kind, std::sqrt(z * z + a * a));
        const double area = (dimension == 2 ? 2.0 : 2 * kPi * a) * most / kRings;
        w += v.w[0] * area, s += v.s[0] * area;
      }
      const auto at = static_cast<size_t>(i);
      slope[at] = sigma / radius * w;
      moment[at] = -2 * sigma / (radius * radius) * s * z;
    }
    share[kIntervals] = shear[kIntervals] = 0;
    const double step = 2 * radius / kIntervals;
    for (size_t i = kIntervals; i-- > 0;) {
      share[i] = share[i + 1] + 0.5 * step * (slope[i] + slope[i + 1]);
      shear[i] = shear[i + 1] + 0.5 * step * (moment[i] + moment[i + 1]);
    }
    // Rings leave an error of some 1e-6; the whole is exactly one.
    const double whole = share[0];
    for (double& x : share) x /= whole;
    for (double& x : slope) x /= whole;
  }

  struct At {
    double share, slope;
  };
  At at(double d) const {
    const double place = position(d);
    const auto i = static_cast<size_t>(place);
    const double f = place - static_cast<double>(i);
    return {share[i] + f * (share[i + 1] - share[i]), slope[i] + f * (slope[i + 1] - slope[i])};
  }
  /// 1/m^2: a wall that holds the fluid on it decelerates a particle by nu (v - v_wall) times this. Behind the
  /// wall the velocity goes on as a straight line through the wall's (Morris, Fox & Zhu 1997).
  double friction(double d, double least) const {
    const double place = position(d);
    const auto i = static_cast<size_t>(place);
    const double f = place - static_cast<double>(i);
    return (shear[i] + f * (shear[i + 1] - shear[i])) / std::max(d, least);
  }

 private:
  double position(double d) const {
    const double p = (d / support + 1) * (kIntervals / 2.0);
    return p > 0 ? std::min(p, kIntervals - 1e-9) : 0;
  }
};

}  // namespace truestep::sph
