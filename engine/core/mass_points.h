// What moving point masses under a uniform weight have together: energies, momenta, centre and extent.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep {

struct MassPoints {
  explicit MassPoints(const Vec3& weight) : gravity(weight) {}

  /// `m` in kg, position in m, velocity in m/s.
  void add(double m, const Vec3& at, const Vec3& u) {
    mass += m, kinetic += 0.5 * m * norm2(u), height -= m * dot(gravity, at);
    momentum += u * m, moment += at * m;
    fastest = std::max(fastest, norm2(u));
    low = {std::min(low.x, at.x), std::min(low.y, at.y), std::min(low.z, at.z)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y), std::max(high.z, at.z)};
  }

  /// m; not a number where there is no mass.
  Vec3 centre() const { return moment / mass; }
  /// m/s, of the fastest.
  double speed() const { return std::sqrt(fastest); }

  /// J, of motion and weight alone.
  double total() const { return kinetic + height; }
  /// m, of the extent; not numbers where there are no points.
  Vec3 lowest() const { return low.x <= high.x ? low : centre(); }
  Vec3 highest() const { return low.x <= high.x ? high : centre(); }

  Vec3 gravity;                                         ///< m/s^2
  double mass = 0;                                      ///< kg
  double kinetic = 0, height = 0;                       ///< J
  double fastest = 0;                                   ///< m^2/s^2
  Vec3 momentum, moment;                                ///< kg m/s, kg m
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;  ///< m
};

}  // namespace truestep
