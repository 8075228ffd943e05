// Points of a rope between two places, equally spaced along it.
#pragma once
#include <optional>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

struct RopeShape {
  Vec3 from{}, to{};               // m
  int links = 20;                  // springs; links + 1 points
  std::optional<double> length{};  // m at rest; absent: the distance from -> to
};

/// Length of a link at rest, m.
double rope_link(const RopeShape& shape);
/// links + 1 positions. A slack rope starts as a parabola of its length, which is close to the catenary it
/// will become; it sags perpendicular to the chord, as far along `down` as possible.
std::vector<Vec3> rope_points(const RopeShape& shape, const Vec3& down);

}  // namespace truestep
