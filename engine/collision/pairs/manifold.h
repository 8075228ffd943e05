// The contact of two bodies that touch or nearly do: up to four points with one normal.
#pragma once
#include <cstdint>

#include "engine/math/vec3.h"

namespace truestep {

struct ContactPoint {
  Vec3 position;          ///< m, midway between both surfaces
  double separation = 0;  ///< m along the normal; negative: depth
  uint32_t id = 0;        ///< identifies the features in contact; constant while they touch
};

struct Manifold {
  static constexpr int kMost = 4;
  Vec3 normal{0, 1, 0};  ///< unit, from the first body to the second
  uint32_t part_a = 0;   ///< triangle of a mesh or height field, part of a compound, else 0
  uint32_t part_b = 0;
  int count = 0;
  ContactPoint points[kMost];

  void add(const Vec3& position, double separation, uint32_t id) {
    if (count < kMost) points[count++] = {position, separation, id};
  }
  /// Depth of the deepest point, negative when all are separated; needs a point.
  double deepest() const {
    double d = -points[0].separation;
    for (int i = 1; i < count; ++i) d = -points[i].separation > d ? -points[i].separation : d;
    return d;
  }
};

}  // namespace truestep
