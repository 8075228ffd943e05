// The box of the atoms: open, or periodic with edges along x, y, z about its centre.
#pragma once
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep::molecular {

enum class Sides : unsigned char { open, periodic };

struct Cell {
  Sides sides = Sides::open;
  Vec3 low, edges;  ///< m

  double volume() const { return edges.x * edges.y * edges.z; }
  /// Number of boxes between x and the first one, along each axis.
  Vec3 image(const Vec3& x) const {
    if (sides == Sides::open) return {};
    return {std::floor((x.x - low.x) / edges.x), std::floor((x.y - low.y) / edges.y),
            std::floor((x.z - low.z) / edges.z)};
  }
  Vec3 wrapped(const Vec3& x) const {
    if (sides == Sides::open) return x;
    const Vec3 n = image(x);
    return {x.x - n.x * edges.x, x.y - n.y * edges.y, x.z - n.z * edges.z};
  }
  /// The shortest of d's images.
  Vec3 nearest(const Vec3& d) const {
    if (sides == Sides::open) return d;
    return {d.x - edges.x * std::nearbyint(d.x / edges.x), d.y - edges.y * std::nearbyint(d.y / edges.y),
            d.z - edges.z * std::nearbyint(d.z / edges.z)};
  }
  friend bool operator==(const Cell&, const Cell&) = default;
};

}  // namespace truestep::molecular
