// A nozzle: layers of points a spacing apart, each a lattice over a disk across the axis (in the plane over a
// line). They are born as deep behind its mouth as a kernel reaches and pushed out at its speed, whatever
// presses against them: what is outside feels the column that comes, as it would of a pipe.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/collision/points/kill_def.h"
#include "engine/core/living_rows.h"
#include "engine/core/real_column.h"
#include "engine/core/source_def.h"
#include "engine/core/system.h"

namespace truestep {

struct Nozzle {
  /// What points stand and fall by: m, between them; how deep behind the mouth they are born; and the widest
  /// that a layer may be (a definition's check comes here with any radius).
  struct Sizes {
    int dimension;
    double spacing, depth, widest;
  };
  Nozzle(const SourceDef& e, const Sizes& sizes);

  Vec3 mouth, along;            ///< m; unit vector
  double radius, reach, depth;  ///< m; reach: within which it holds what is in it
  double speed;                 ///< m/s
  double start, stop, pause;    ///< s; the time from layer to layer
  std::vector<Vec3> places;     ///< m, of a layer's points about the axis

  Vec3 velocity() const { return along * speed; }
  Vec3 back() const { return mouth - along * depth; }
  /// s, when layer n is born; infinity where there is none.
  double birth(uint64_t n) const {
    const double t = start + static_cast<double>(n) * pause;
    return t < stop ? t : std::numeric_limits<double>::infinity();
  }
  /// Points over all time, or infinity.
  double most() const {
    return (std::max(stop - start, 0.0) / pause + 1) * static_cast<double>(places.size());
  }
  /// Whether what is at x at time t is pushed out of the nozzle; `more` m beyond its points.
  bool holds(const Vec3& x, double t, double more = 0) const {
    if (t < start || t > stop + depth / speed) return false;
    const Vec3 r = x - mouth;
    const double way = dot(r, along), wide = reach + more;
    return way < 0 && way > -1.5 * depth && norm2(r - along * way) < wide * wide;
  }
  /// Visits the places, where they are by then, of the layers from `next` on that are born before t; places
  /// that are within `room` m of a point there already are left out: what was in the nozzle is pushed out,
  /// not doubled. `position` is the column of points, `add` may add rows to it.
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

/// Flags the rows of `position` that are in kill regions; how many. `dead` must have its memory.
uint64_t find_killed(const KillDefs& regions, const State& s, State::Column position,
                     const ThreadArena& arena, std::vector<uint8_t>& dead);

}  // namespace truestep
