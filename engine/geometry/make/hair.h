// Points of a bundle of straight strands whose roots are spread evenly over a disc.
#pragma once
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

struct HairShape {
  Vec3 root{};  // m, centre of the roots' disc
  double radius = 0.1;
  int strands = 50;
  int links = 16;
  double length = 0.5;
  Vec3 direction{0, -1, 0};
};

/// Strand after strand, links + 1 positions each, root first.
std::vector<Vec3> hair_points(const HairShape& shape);

}  // namespace truestep
