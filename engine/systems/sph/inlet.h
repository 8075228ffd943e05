// A nozzle: layers of particles a spacing apart, each a lattice over a disk across the axis (in the plane
// over a line). They are born as deep behind its mouth as the kernel reaches and pushed out at its speed,
// whatever presses against them: the liquid feels the column that comes, as it would in a pipe.
#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "engine/systems/sph/sph_def.h"

namespace truestep::sph {

struct Inlet {
  Inlet(const SphDef& d, const InletDef& e);

  Vec3 mouth, along;            ///< m; unit vector
  double radius, reach, depth;  ///< m; reach: within which it holds what is in it
  double speed, ratio;          ///< m/s; density over the system's
  double start, stop, pause;    ///< s; the time from layer to layer
  std::vector<Vec3> places;     ///< m, of a layer's particles about the axis

  Vec3 velocity() const { return along * speed; }
  Vec3 back() const { return mouth - along * depth; }
  /// s, when layer n is born; infinity where there is none.
  double birth(uint64_t n) const {
    const double t = start + static_cast<double>(n) * pause;
    return t < stop ? t : std::numeric_limits<double>::infinity();
  }
  /// Particles over all time, or infinity.
  double most() const {
    return (std::max(stop - start, 0.0) / pause + 1) * static_cast<double>(places.size());
  }
  /// Whether what is at x at time t is pushed out of the nozzle.
  bool holds(const Vec3& x, double t) const {
    if (t < start || t > stop + depth / speed) return false;
    const Vec3 r = x - mouth;
    const double way = dot(r, along);
    return way < 0 && way > -1.5 * depth && norm2(r - along * way) < reach * reach;
  }
};

}  // namespace truestep::sph
