// Elementary functions with the same bits on every machine. The C library's differ between versions and
// processors, so nothing on a step's path may call them. Built from + - * / sqrt and fused multiply-add only;
// polynomials are our own minimax fits, arguments are reduced with an error term. Errors, measured against
// 64-bit mantissas, in units in the last place: sin cos 0.77, exp pow 0.67, log 0.81, atan atan2 acos asin
// 0.61, tan 2.1. NaN in, NaN out; poles and overflow as in IEEE 754.
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>

namespace truestep::trig {

struct SinCos {
  double sin, cos;
};

namespace detail {

/// x = k pi/2 + (hi + lo), |hi| <= pi/4 (or barely more); k modulo 4.
struct Reduced {
  double hi, lo;
  int quadrant;
};
/// Any finite x, by multiplying with 2/pi to as many bits as needed (Payne, Hanek 1983).
Reduced reduce_huge(double x);

/// |x| <= 2^30 or so: pi/2 in four parts of 53 bits (Cody, Waite 1980), error-free products.
inline Reduced reduce(double x) {
  constexpr double kP1 = 0x1.921fb54442d18p+0, kP2 = 0x1.1a62633145c07p-54, kP3 = -0x1.f1976b7ed8fbcp-110;
  if (!(std::abs(x) < 0x1p30)) return reduce_huge(x);
  if (std::abs(x) <= 0x1.921fb54442d18p-1) return {x, 0, 0};
  // Adding and subtracting 1.5 2^52 rounds to the nearest integer.
  const double k = std::fma(x, 0x1.45f306dc9c883p-1, 0x1.8p52) - 0x1.8p52;
  const double p = k * kP1, p_lo = std::fma(k, kP1, -p);
  const double r = x - p;  // exact
  const double q = k * kP2, q_lo = std::fma(k, kP2, -q);
  const double s = p_lo + q, s_lo = (p_lo - (s - q)) + (q - (s - (s - q)));
  const double hi = r - s;
  const double b = r - hi;
  const double lo = ((b - s) + (r - (hi + b))) - (s_lo + q_lo + k * kP3);
  const double sum = hi + lo;
  return {sum, lo - (sum - hi), static_cast<int>(static_cast<int64_t>(k) & 3)};
}

/// sin(hi + lo) for |hi| <= pi/4.
inline double sin_kernel(double hi, double lo) {
  const double u = hi * hi;
  const double p =
      std::fma(u,
               std::fma(u,
                        std::fma(u,
                                 std::fma(u, std::fma(u, 0x1.5d932f428b12dp-33, -0x1.ae5e66d518bacp-26),
                                          0x1.71de357875272p-19),
                                 -0x1.a01a019c126cep-13),
                        0x1.111111110f881p-7),
               -0x1.5555555555549p-3);
  // sin(hi) + lo cos(hi), the second factor to second order.
  return hi + std::fma(u * hi, p, std::fma(-0.5 * u, lo, lo));
}
/// cos(hi + lo) for |hi| <= pi/4.
inline double cos_kernel(double hi, double lo) {
  const double u = hi * hi;
  const double p =
      std::fma(u,
               std::fma(u,
                        std::fma(u,
                                 std::fma(u, std::fma(u, -0x1.8faece417ce6bp-37, 0x1.1ee9ec463ed33p-29),
                                          -0x1.27e4f80a74d93p-22),
                                 0x1.a01a019cb26e0p-16),
                        -0x1.6c16c16c15184p-10),
               0x1.555555555554cp-5);
  const double half = 0.5 * u, w = 1 - half;
  return w + (((1 - w) - half) + std::fma(u * u, p, -hi * lo));
}

}  // namespace detail

/// Sine and cosine of x (rad).
inline SinCos sincos(double x) {
  const detail::Reduced r = detail::reduce(x);
  const double s = detail::sin_kernel(r.hi, r.lo), c = detail::cos_kernel(r.hi, r.lo);
  const double a = r.quadrant & 1 ? c : s, b = r.quadrant & 1 ? s : c;
  return {r.quadrant & 2 ? -a : a, (r.quadrant + 1) & 2 ? -b : b};
}
inline double sin(double x) {
  return sincos(x).sin;
}
inline double cos(double x) {
  return sincos(x).cos;
}
double tan(double x);

/// e^x; 0 below -745.2, infinity above 709.8.
double exp(double x);
/// Natural logarithm; -infinity at 0, NaN below.
double log(double x);
/// x^y for all x and y of IEEE 754-2019, section 9.2.1.
double pow(double x, double y);
/// Angle of (x, y) in (-pi, pi], rad.
double atan2(double y, double x);
double atan(double x);
/// Angle in [0, pi] whose cosine is x; NaN outside [-1, 1].
double acos(double x);
/// Angle in [-pi/2, pi/2] whose sine is x; NaN outside [-1, 1].
double asin(double x);

}  // namespace truestep::trig
