// Shared by the laws: moduli of the longer ones, and a logarithm that continues as a polynomial.
#pragma once
#include "engine/kernels/fem/material.h"
#include "engine/math/trig.h"

namespace truestep::fem {

/// ln J, continued below kFloor by its second-order Taylor polynomial, with derivatives.
struct Log {
  double l, dl, ddl;
};
inline Log log_of(double j) {
  if (j >= kFloor) return {trig::log(j), 1 / j, -1 / (j * j)};
  static const double kLogFloor = trig::log(kFloor);
  const double r = (j - kFloor) / kFloor;
  return {kLogFloor + r - 0.5 * r * r, (1 - r) / kFloor, -1 / (kFloor * kFloor)};
}

struct Smith {
  double m, l, a;
};
inline Smith smith_of(const Material& mat) {
  const double m = 4.0 / 3 * mat.mu, l = mat.lambda + 5.0 / 6 * mat.mu;
  return {m, l, 1 + 0.75 * m / l};
}

struct Mooney {
  double c1, c2, d, l;
};
inline Mooney mooney_of(const Material& mat) {
  const double c2 = 0.5 * mat.mu * mat.second, c1 = 0.5 * mat.mu - c2;
  return {c1, c2, 2 * (c1 + 2 * c2), mat.lambda - 4 * c2};
}

/// If the sum of two singular values is nearly 0 the nearest rotation is undefined; the bound keeps the
/// numbers finite.
inline double sum_of_stretches(double s, double t) {
  constexpr double kLeast = 1e-8;
  return std::abs(s + t) > kLeast ? s + t : std::copysign(kLeast, s + t);
}

}  // namespace truestep::fem
