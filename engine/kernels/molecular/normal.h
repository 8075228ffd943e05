// Normally distributed numbers with mean 0 and variance 1 as functions of (seed, stream, counter): Box and
// Muller 1958,
//   sqrt(-2 log u1) (cos, sin)(2 pi u2), of Philox's numbers and math/trig, the same bits everywhere.
// Also sums of squares of many of them: gamma-distributed numbers by Marsaglia and Tsang 2000.
#pragma once
#include <array>
#include <cmath>

#include "engine/base/random.h"
#include "engine/math/trig.h"
#include "engine/math/vec3.h"

namespace truestep::molecular {

inline std::array<double, 4> normal4(uint64_t seed, uint64_t stream, uint64_t counter) {
  constexpr double kTurn = 6.283185307179586;
  const auto u = uniform4(seed, stream, counter);
  std::array<double, 4> out;
  for (size_t k = 0; k < 4; k += 2) {
    // The midpoint of the interval that the 32 bits stand for: never 0.
    const double r = std::sqrt(-2 * trig::log(u[k] + 0x1p-33));
    const trig::SinCos a = trig::sincos(kTurn * u[k + 1]);
    out[k] = r * a.cos, out[k + 1] = r * a.sin;
  }
  return out;
}
inline Vec3 normal3(uint64_t seed, uint64_t stream, uint64_t counter) {
  const auto n = normal4(seed, stream, counter);
  return {n[0], n[1], n[2]};
}

/// Sum of the squares of `count` (at least 1) normal numbers: twice a gamma-distributed number with shape
/// count / 2. Draws from counter `counter` on; needs a stream of its own.
inline double squares_of_normals(double count, uint64_t seed, uint64_t stream, uint64_t counter) {
  double shape = 0.5 * count, boost = 1;
  if (shape < 1) {
    // gamma(a) = gamma(a + 1) u^(1/a)
    boost = trig::exp(trig::log(uniform4(seed, stream, counter++)[0] + 0x1p-33) / shape), shape += 1;
  }
  const double d = shape - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  for (;; ++counter) {
    const auto u = uniform4(seed, stream, counter);
    const double r = std::sqrt(-2 * trig::log(u[0] + 0x1p-33));
    const double x = r * trig::sincos(6.283185307179586 * u[1]).cos, t = 1 + c * x, v = t * t * t;
    if (v > 0 && trig::log(u[2] + 0x1p-33) < 0.5 * x * x + d - d * v + d * trig::log(v)) {
      return 2 * d * v * boost;
    }
  }
}

}  // namespace truestep::molecular
