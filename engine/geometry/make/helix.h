// Points on a helix at equal distances: a coil, an arc or a ring (pitch 0), left-handed with a negative
// pitch.
#pragma once
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

struct HelixShape {
  Vec3 centre{};        // m, on the axis, in the plane of the first point
  Vec3 axis{0, 1, 0};   // along which it rises
  Vec3 start{1, 0, 0};  // direction from the centre to the first point; its component along the axis is
                        // ignored
  double radius = 0.1;  // m
  double pitch = 0.05;  // m, rise per turn
  double turns = 5;
  int links = 100;  // springs; links + 1 points
};

/// Distance between neighbours, m.
double helix_link(const HelixShape& shape);
/// links + 1 positions.
std::vector<Vec3> helix_points(const HelixShape& shape);

}  // namespace truestep
