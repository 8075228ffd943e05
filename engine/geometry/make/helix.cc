#include "engine/geometry/make/helix.h"

#include <cmath>

#include "engine/math/trig.h"

namespace truestep {

namespace {
constexpr double kTurn = 6.283185307179586;
}

double helix_link(const HelixShape& shape) {
  const double turn = shape.turns / shape.links;
  const double chord = 2 * shape.radius * trig::sin(0.5 * kTurn * turn), rise = shape.pitch * turn;
  return std::sqrt(chord * chord + rise * rise);
}

std::vector<Vec3> helix_points(const HelixShape& shape) {
  const Vec3 axis = normalized(shape.axis);
  const Vec3 u = normalized(shape.start - axis * dot(axis, shape.start)), w = cross(axis, u);
  std::vector<Vec3> x;
  for (int i = 0; i <= shape.links; ++i) {
    const double turns = shape.turns * i / shape.links;
    const auto [s, c] = trig::sincos(kTurn * turns);
    x.push_back(shape.centre + (shape.radius * c) * u + (shape.radius * s) * w +
                (shape.pitch * turns) * axis);
  }
  return x;
}

}  // namespace truestep
