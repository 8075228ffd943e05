// The right-hand sides of the convergence problems over any scalar type, so that a method can be followed
// with more digits than double has:
//   spring      x'' = -4 x - c x'
//   Kepler      x'' = -x / |x|^3
//   free body   w' = I^-1 (I w x w), q' = 1/2 q (0, w), moments of inertia 1, 2 and 3.5
#pragma once
#include <array>
#include <cmath>

namespace truestep::test {

#if defined(__SIZEOF_FLOAT128__)
using Extended = __float128;
#else
using Extended = long double;
#endif

/// Square root: that of double, refined by Newton's method.
inline double root(double x) {
  return std::sqrt(x);
}
inline Extended root(Extended x) {
  Extended r = std::sqrt(static_cast<double>(x));
  for (int i = 0; i < 3; ++i) r = (r + x / r) / 2;
  return r;
}

template <class R>
void kepler_acceleration(const R* x, R* a) {
  const R r2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2], factor = R(-1) / (r2 * root(r2));
  for (int i = 0; i < 3; ++i) a[i] = factor * x[i];
}

inline constexpr std::array<double, 3> kMoments = {1, 2, 3.5};

template <class R>
void free_body_acceleration(const R* w, R* a) {
  for (size_t i = 0; i < 3; ++i) {
    const size_t j = (i + 1) % 3, k = (i + 2) % 3;
    a[i] = R(kMoments[j] - kMoments[k]) * w[j] * w[k] / R(kMoments[i]);
  }
}
template <class R>
void free_body_rate(const R* q, const R* w, R* d) {
  const R half = R(1) / 2;
  d[0] = -half * (q[1] * w[0] + q[2] * w[1] + q[3] * w[2]);
  d[1] = half * (q[0] * w[0] + q[2] * w[2] - q[3] * w[1]);
  d[2] = half * (q[0] * w[1] + q[3] * w[0] - q[1] * w[2]);
  d[3] = half * (q[0] * w[2] + q[1] * w[1] - q[2] * w[0]);
}
template <class R>
void normalise(R* q) {
  const R n = root(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4; ++i) q[i] /= n;
}

}  // namespace truestep::test
