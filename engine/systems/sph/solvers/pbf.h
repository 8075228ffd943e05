// Position based fluids (Macklin & Mueller 2013): positions are corrected along the gradient of each
// particle's density until it is the rest density; velocities follow from positions. Particles that come too
// close push each other apart by an artificial pressure (their equation 13).
#pragma once
#include <algorithm>

#include "engine/systems/sph/bodies.h"
#include "engine/systems/sph/neighbours.h"
#include "engine/systems/sph/walls.h"

namespace truestep::sph {

template <int D, class T>
class Pbf {
 public:
  Pbf(const Setting& set, const Neighbours<D, T>& neighbours, const BoxWalls<D, T>& walls)
      : set_(set),
        neighbours_(neighbours),
        walls_(walls),
        per_near_(static_cast<T>(1 / (set.kernel_w * smoothing_at(set.def.kernel, kNear).w[0]))) {}

  /// Corrects the positions, and velocities, of particles that have moved for h s; t is the substep's end.
  /// f.flow is the sum of all corrections' pushes (m^2).
  void correct(Fluid<D, T>& f, BodiesIn<D, T>& bodies, double t, double h, const ThreadArena& arena) const;

 private:
  using W = Wide<T>;
  static constexpr double kNear = 0.2;  ///< radii, at which the artificial pressure has its nominal strength
  static constexpr double kRelief = 0.1;  ///< epsilon of their equation 11, over the square of the spacing
                                          ///< and the particle's density

  void renew(Fluid<D, T>& f, BodiesIn<D, T>& bodies, double t, const ThreadArena& arena) const;

  /// Adds to f.a the correction that keeps particles from coming closer than at rest.
  void part(Fluid<D, T>& f, const ThreadArena& arena) const;

  /// Positions change by f.a (m), velocities by the same per substep.
  void shift(Fluid<D, T>& f, double t, T per_h, const ThreadArena& arena) const;

  const Setting& set_;
  const Neighbours<D, T>& neighbours_;
  const BoxWalls<D, T>& walls_;
  T per_near_;
};

}  // namespace truestep::sph
