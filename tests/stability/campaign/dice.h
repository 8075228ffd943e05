// Random draws of a trial: the n-th draw of a seed is always the same number (Philox).
#pragma once
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "engine/base/random.h"
#include "engine/math/vec3.h"

namespace truestep::campaign {

class Dice {
 public:
  Dice(uint64_t seed, uint64_t stream) : seed_(seed), stream_(stream) {}
  /// Uniform in [0, 1).
  double unit() { return uniform4(seed_, stream_, count_++)[0]; }
  /// Uniform in [low, high).
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// Its logarithm is uniform.
  double spread(double low, double high) { return low * std::pow(high / low, unit()); }
  /// Whole, both ends included.
  int whole(int low, int high) { return low + static_cast<int>((high - low + 1) * unit()); }
  bool chance(double p) { return unit() < p; }
  double sign() { return chance(0.5) ? 1 : -1; }
  template <class T>
  T of(std::initializer_list<T> choices) {
    return choices.begin()[whole(0, static_cast<int>(choices.size()) - 1)];
  }
  Vec3 in_cube(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }
  /// Uniform on the unit sphere.
  Vec3 direction() {
    const double z = between(-1, 1), a = between(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(a), r * std::sin(a), z};
  }

 private:
  uint64_t seed_, stream_, count_ = 0;
};

}  // namespace truestep::campaign
