// Smoothing kernels of compact support: the cubic spline (Monaghan 1992), Wendland's C2 and C4 functions
// (Dehnen & Aly 2012), and the pair of Mueller, Charypar & Gross 2003, in the plane and in space. With q = r
// / H and H the radius of the support, W(r) = sigma / H^D w(q) and dW/dr / r = sigma / H^(D + 2) s(q). Both
// vanish at q = 1. The pair takes values from one kernel, poly6 (1 - q^2)^3, and slopes from another, spiky
// (1 - q)^3, each with its own sigma: poly6 does not push close particles apart.
#pragma once
#include <algorithm>

#include "engine/kernels/sph/smoothing_values.h"
#include "engine/math/wide.h"

namespace truestep::sph {

/// Whether slopes are the derivative of the values; otherwise they are another kernel's.
constexpr bool slopes_of_values(Smoothing k) {
  return k != Smoothing::poly6_spiky;
}

template <class T>
using SmoothingValue = SmoothingLanes<Wide<T>>;

template <Smoothing K, class T>
inline SmoothingValue<T> smoothing(const Wide<T>& q) {
  return smoothing_of<K, T>(q);
}

/// Makes the integral of W over the whole space 1.
constexpr double smoothing_sigma(Smoothing k, int dimension) {
  constexpr double kPi = 3.14159265358979323846;
  const bool plane = dimension == 2;
  switch (k) {
    case Smoothing::cubic:
      return plane ? 40 / (7 * kPi) : 8 / kPi;
    case Smoothing::wendland_c2:
      return plane ? 7 / kPi : 21 / (2 * kPi);
    case Smoothing::wendland_c4:
      return plane ? 9 / kPi : 495 / (32 * kPi);
    case Smoothing::poly6_spiky:
      break;
  }
  return plane ? 4 / kPi : 315 / (64 * kPi);
}
/// The same for the kernel that slopes are taken from.
constexpr double slope_sigma(Smoothing k, int dimension) {
  constexpr double kPi = 3.14159265358979323846;
  if (slopes_of_values(k)) return smoothing_sigma(k, dimension);
  return (dimension == 2 ? 10 : 15) / kPi;
}

/// The same for a single number, with the kernel chosen at run time.
inline SmoothingValue<double> smoothing_at(Smoothing k, double q) {
  const Wide<double> x = Wide<double>::all(q);
  if (!(q < 1)) return {Wide<double>::zero(), Wide<double>::zero()};
  switch (k) {
    case Smoothing::cubic:
      return smoothing<Smoothing::cubic>(x);
    case Smoothing::wendland_c2:
      return smoothing<Smoothing::wendland_c2>(x);
    case Smoothing::wendland_c4:
      return smoothing<Smoothing::wendland_c4>(x);
    case Smoothing::poly6_spiky:
      break;
  }
  return smoothing<Smoothing::poly6_spiky>(x);
}

/// The maximum of q |s(q)|: the steepest gradient in units of sigma / H^(D + 1).
inline double steepest(Smoothing k) {
  constexpr int kPlaces = 1000;
  double out = 0;
  for (int i = 1; i < kPlaces; ++i) {
    const double q = static_cast<double>(i) / kPlaces;
    out = std::max(out, -q * smoothing_at(k, q).s[0]);
  }
  return out;
}

}  // namespace truestep::sph
