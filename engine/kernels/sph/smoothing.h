// Smoothing kernels of compact support: the cubic spline (Monaghan 1992), Wendland's C2 and C4 functions
// (Dehnen & Aly 2012), and the pair of Mueller, Charypar & Gross 2003, in the plane and in space. With q = r
// / H and H the radius of the support, W(r) = sigma / H^D w(q) and dW/dr / r = sigma / H^(D + 2) s(q). Both
// vanish at q = 1. The pair takes values from one kernel, poly6 (1 - q^2)^3, and slopes from another, spiky
// (1 - q)^3, each with its own sigma: poly6 does not push close particles apart.
#pragma once
#include <algorithm>
#include <cstdint>

#include "engine/math/wide.h"

namespace truestep::sph {

enum class Smoothing : uint8_t { cubic, wendland_c2, wendland_c4, poly6_spiky };

/// Whether slopes are the derivative of the values; otherwise they are another kernel's.
constexpr bool slopes_of_values(Smoothing k) {
  return k != Smoothing::poly6_spiky;
}

namespace smoothing_detail {
template <class T>
Wide<T> real(double x) {
  return Wide<T>::all(static_cast<T>(x));
}
}  // namespace smoothing_detail

/// w and s of q in [0, 1].
template <class T>
struct SmoothingValue {
  Wide<T> w, s;
};

template <Smoothing K, class T>
inline SmoothingValue<T> smoothing(const Wide<T>& q) {
  using smoothing_detail::real;
  const Wide<T> u = real<T>(1) - q, u2 = u * u;
  if constexpr (K == Smoothing::cubic) {
    const Wide<T> inner_w = madd(real<T>(6) * q * q, q - real<T>(1), real<T>(1));
    const Wide<T> inner_s = madd(real<T>(18), q, real<T>(-12));
    const Wide<T> outer_w = real<T>(2) * u2 * u;
    // Used only above a half, where q is far from 0.
    const Wide<T> outer_s = real<T>(-6) * u2 / max(q, real<T>(0.5));
    const auto near = q < real<T>(0.5);
    return {select(near, inner_w, outer_w), select(near, inner_s, outer_s)};
  } else if constexpr (K == Smoothing::wendland_c2) {
    return {u2 * u2 * madd(real<T>(4), q, real<T>(1)), real<T>(-20) * u2 * u};
  } else if constexpr (K == Smoothing::poly6_spiky) {
    const Wide<T> p = real<T>(1) - q * q;
    // The gradient's size tends to 3 at q = 0, where it has no direction.
    return {p * p * p, real<T>(-3) * u2 / max(q, real<T>(1e-3))};
  } else {
    const Wide<T> u4 = u2 * u2;
    const Wide<T> p = madd(madd(real<T>(35.0 / 3), q, real<T>(6)), q, real<T>(1));
    return {u4 * u2 * p, real<T>(-56.0 / 3) * u4 * u * madd(real<T>(5), q, real<T>(1))};
  }
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
