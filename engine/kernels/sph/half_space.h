// Contribution of a wall to the sums of a nearby particle: the fluid continues behind the wall in layers one
// spacing apart, the first half a spacing behind it, each spread evenly over its plane. Shares and slopes as
// functions of the distance d (m) of the particle from the wall (boundary particles of several layers,
// without the noise of their positions; compare the volume maps of Bender et al. 2019). For walls that are
// flat over a kernel. Tables with 512 intervals over d in [-s/2, H], linear between.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/kernels/sph/smoothing.h"

namespace truestep::sph {

struct HalfSpace {
  static constexpr int kIntervals = 512;
  double from = 0, per_metre = 1;
  std::array<double, kIntervals + 1> share{};  ///< 1, of the kernel that lies behind the wall
  std::array<double, kIntervals + 1> slope{};  ///< 1/m, -d share / d d, from the kernel's slopes

  /// Sets the tables for a kernel of radius H and particles `spacing` (m) apart.
  void set(Smoothing kind, int dimension, double radius, double spacing) {
    from = -0.5 * spacing, per_metre = kIntervals / (radius - from);
    double whole = plane(kind, dimension, 0).w, steep = 0;
    for (double z = spacing; z < radius; z += spacing) {
      const Plane p = plane(kind, dimension, z / radius);
      whole += 2 * p.w, steep -= 2 * p.s * (z / radius) * (z / radius);
    }
    // Slopes of the same kernel scale with its values; those of another are scaled to give the gradient 1 of
    // a straight line.
    if (slopes_of_values(kind)) steep = whole;
    for (int i = 0; i <= kIntervals; ++i) {
      const auto at = static_cast<size_t>(i);
      share[at] = slope[at] = 0;
      for (double z = from + i / per_metre + 0.5 * spacing; z < radius; z += spacing) {
        const Plane p = plane(kind, dimension, std::max(z, 0.0) / radius);
        share[at] += p.w / whole;
        slope[at] -= p.s * z / (radius * radius) / steep;
      }
    }
  }

  struct At {
    double share, slope;
  };
  At at(double d) const {
    const double place = std::min(std::max((d - from) * per_metre, 0.0), kIntervals - 1e-9);
    const auto i = static_cast<size_t>(place);
    const double f = place - static_cast<double>(i);
    return {share[i] + f * (share[i + 1] - share[i]), slope[i] + f * (slope[i + 1] - slope[i])};
  }
  /// 1, the share at any distance, behind the wall too.
  double share_at(double d) const { return d >= 0 ? at(d).share : 1 - at(-d).share; }
  /// 1/m^2: a no-slip wall decelerates a particle by nu (v - v_wall) times this. Behind the wall the velocity
  /// continues on a straight line through the wall's (Morris, Fox & Zhu 1997), so the sum of -2 dW/dr / r (1
  /// + depth / d) over the layers is twice the slope over d.
  double friction(double d, double least) const { return 2 * at(d).slope / std::max(d, least); }

 private:
  struct Plane {
    double w, s;
  };
  /// Integrals of w and s over the plane at distance z, in kernel radii.
  static Plane plane(Smoothing kind, int dimension, double z) {
    constexpr double kPi = 3.14159265358979323846;
    constexpr int kRings = 256;
    const double most = std::sqrt(std::max(0.0, 1 - z * z));
    Plane out{0, 0};
    for (int k = 0; k < kRings; ++k) {
      const double a = (k + 0.5) / kRings * most;
      const SmoothingValue<double> v = smoothing_at(kind, std::sqrt(z * z + a * a));
      const double area = (dimension == 2 ? 2.0 : 2 * kPi * a) * most / kRings;
      out.w += v.w[0] * area, out.s += v.s[0] * area;
    }
    return out;
  }
};

}  // namespace truestep::sph
