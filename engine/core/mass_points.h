// What moving point masses under a uniform weight have together: energies, momenta, centre and extent, as
// observables with the names and units that every system of particles gives them.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>

#include "engine/core/observables.h"
#include "engine/math/vec3.h"

namespace truestep {

/// name.x, name.y and name.z.
void add_vector(Observables& out, const std::string& name, const Vec3& a, const char* unit);

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

  /// Of motion and weight alone.
  void observe_energy(Observables& out) const;
  void observe_centre(Observables& out) const;
  /// Not numbers where there are no points.
  void observe_extent(Observables& out) const;

  Vec3 gravity;                                         ///< m/s^2
  double mass = 0;                                      ///< kg
  double kinetic = 0, height = 0;                       ///< J
  double fastest = 0;                                   ///< m^2/s^2
  Vec3 momentum, moment;                                ///< kg m/s, kg m
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;  ///< m
};

}  // namespace truestep
