// Which solids a box with periodic sides repeats. A solid that reaches through both sides of an axis, as a
// rail along it does, goes on by itself; planes, containers and ground do so too.
#pragma once
#include "engine/collision/points/images.h"
#include "engine/collision/points/near_surfaces.h"
#include "engine/geometry/box.h"
#include "engine/systems/sph/sph_def.h"

namespace truestep::sph {

/// Of a solid with these bounds (m).
inline Images images_of(const SphDef& d, const Box& solid) {
  Images out;
  const double low[3] = {d.low.x, d.low.y, d.low.z}, high[3] = {d.high.x, d.high.y, d.high.z};
  const double from[3] = {solid.low.x, solid.low.y, solid.low.z},
               to[3] = {solid.high.x, solid.high.y, solid.high.z};
  for (int a = 0; a < d.dimension; ++a) {
    if (d.wraps(a) && !(from[a] <= low[a] && to[a] >= high[a])) out.period[a] = high[a] - low[a];
  }
  return out;
}

/// Of a collider as it is placed at the start.
inline Images images_of(const SphDef& d, const Collider& c) {
  if (c.shape.kind == ShapeKind::plane || c.shape.side == PointSide::inside) return {};
  const auto along = [&](double x, double y, double z) { return farthest_along(c, c.start, {x, y, z}); };
  const Vec3 up{along(1, 0, 0), along(0, 1, 0), along(0, 0, 1)},
      down{along(-1, 0, 0), along(0, -1, 0), along(0, 0, -1)};
  return images_of(d, Box{c.start.position - down, c.start.position + up});
}

/// f(shift) for every image of a solid that may reach into the box; `radius` (m) of a ball about its origin.
template <class F>
void each_in_box(const SphDef& d, const Images& images, const Vec3& origin, double radius, const F& f) {
  const Vec3 half = (d.high - d.low) * 0.5, more{radius, radius, radius};
  images.each(d.low + half - origin, half + more, f);
}

}  // namespace truestep::sph
