// A nozzle: layers of points one spacing apart, each a lattice over a disk perpendicular to the axis (over a
// line in the plane). Points are created behind the mouth at a depth of the kernel's reach and pushed out at
// the nozzle's speed, whatever the pressure: the fluid outside feels the advancing column as it would at a
// pipe.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/collision/points/kill_def.h"
#include "engine/core/def/source_def.h"
#include "engine/core/state/living_rows.h"
#include "engine/core/state/real_column.h"
#include "engine/core/system.h"

namespace truestep {

struct Nozzle {
  /// The sizes that depend on the system: m, spacing of points; depth behind the mouth at which they are
  /// created; and the largest width of a layer (definitions are checked here with any radius).
  struct Sizes {
    int dimension;
    double spacing, depth, widest;
  };
  Nozzle(const SourceDef& e, const Sizes& sizes);

  Vec3 mouth, along;            ///< m; unit vector
  double radius, reach, depth;  ///< m; reach: radius within which the nozzle carries points
  double speed;                 ///< m/s
  double start, stop, pause;    ///< s; pause: time between layers
  std::vector<Vec3> places;     ///< m, positions of a layer's points relative to the axis

  Vec3 velocity() const { return along * speed; }
  Vec3 back() const { return mouth - along * depth; }
  /// s, time at which layer n is created; infinity if there is none.
  double birth(uint64_t n) const {
    const double t = start + static_cast<double>(n) * pause;
    return t < stop ? t : std::numeric_limits<double>::infinity();
  }
  /// Number of points over all time, or infinity.
  double most() const {
    return (std::max(stop - start, 0.0) / pause + 1) * static_cast<double>(places.size());
  }
  /// Whether a point at x is carried by the nozzle at time t; `more` widens the nozzle by that many m.
  bool holds(const Vec3& x, double t, double more = 0) const {
    if (t < start || t > stop + depth / speed) return false;
    const Vec3 r = x - mouth;
    const double way = dot(r, along), wide = reach + more;
    return way < 0 && way > -1.5 * depth && norm2(r - along * way) < wide * wide;
  }
  /// Calls add(position) for the layers from `next` on that are created before t, at their positions at time
  /// t. Positions closer than `room` (m) to an existing point are left out: material already in the nozzle is
  /// pushed out, not doubled. `position` is the column of the points, to which `add` may append rows.
  template <class Add>
  void pour(const State& s, State::Column position, uint64_t& next, double t, double room,
            std::vector<Vec3>& near, const Add& add) const {
    for (double born; (born = birth(next)) < t; ++next) {
      const Vec3 at = back() + velocity() * (t - born);
      near.clear();
      const RealColumn<const double> x(s, position);
      for (size_t i = 0; i < s.rows(position); ++i) {
        if (std::abs(dot(x.vector(i) - at, along)) < room) near.push_back(x.vector(i));
      }
      for (const Vec3& place : places) {
        const Vec3 p = at + place;
        const auto close = [&](const Vec3& other) { return norm2(other - p) < room * room; };
        if (std::none_of(near.begin(), near.end(), close)) add(p);
      }
    }
  }
};

/// Flags the rows of `position` that are in kill regions and returns their number. Does not allocate if
/// `dead` has the capacity.
uint64_t find_killed(const KillDefs& regions, const State& s, State::Column position,
                     const ThreadArena& arena, std::vector<uint8_t>& dead);

}  // namespace truestep
