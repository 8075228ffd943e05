// What all particle sources have in common: a place, an axis, a disk across it, a speed along it and a time
// interval.
#pragma once
#include <optional>

#include "engine/core/def/def.h"
#include "engine/math/vec3.h"

namespace truestep {

struct SourceDef {
  Vec3 position, direction{0, 1, 0};
  double radius = 0.1, speed = 1, start = 0;
  std::optional<double> stop;
};

/// Reports why the source makes no sense, as the check of a def derived from it.
inline void check_source(const SourceDef& d, const DefTable::Report& report) {
  if (!(norm(d.direction) > 0)) report("/direction", "the direction must not be zero");
}

/// The rows of a def derived from it.
template <class D>
TableOf<D>& add_source_rows(TableOf<D>& table) {
  Vec3 D::*position = &SourceDef::position;
  Vec3 D::*direction = &SourceDef::direction;
  double D::*radius = &SourceDef::radius;
  double D::*speed = &SourceDef::speed;
  double D::*start = &SourceDef::start;
  std::optional<double> D::*stop = &SourceDef::stop;
  return table.vector("position", position, "m", any(), "centre, or one end of a line")
      .vector("direction", direction, "1", any(), "direction of the flow, axis of a disk or cone; any length")
      .number("radius", radius, "m", at_least(0), "of a disk or ball")
      .number("speed", speed, "m/s", any(), "mean speed")
      .number("start", start, "s", at_least(0), "time of the first particle")
      .number("stop", stop, "s", at_least(0), "no particles from then on; absent: never stops");
}

}  // namespace truestep
