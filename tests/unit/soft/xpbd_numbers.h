// Numbers and derivatives for tests of constraints.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep::xpbd::testing_numbers {

/// Deterministic numbers in [-1, 1).
struct Numbers {
  uint64_t state = 88172645463325252ull;
  double operator()() {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return static_cast<double>(state >> 11) * 0x1p-52 - 1;
  }
  Vec3 vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }
};

/// d f / d x_i by central differences.
inline Vec3 slope(const std::function<double(const std::vector<Vec3>&)>& f, std::vector<Vec3> x, size_t i) {
  constexpr double kStep = 1e-5;
  double out[3];
  for (size_t k = 0; k < 3; ++k) {
    const Vec3 e{k == 0 ? kStep : 0, k == 1 ? kStep : 0, k == 2 ? kStep : 0}, here = x[i];
    x[i] = here + e;
    const double up = f(x);
    x[i] = here - e;
    out[k] = (up - f(x)) / (2 * kStep);
    x[i] = here;
  }
  return {out[0], out[1], out[2]};
}

}  // namespace truestep::xpbd::testing_numbers
