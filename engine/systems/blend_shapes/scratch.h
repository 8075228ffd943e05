// Columns of the state of blend_shapes, and what a step works on.
#pragma once
#include <vector>

#include "engine/systems/blend_shapes/blend_shapes.h"

namespace truestep::blend_shapes {

namespace columns {
enum : State::Column { kPosition, kVelocity, kInverseMass, kControl };
}

struct BlendShapes::Scratch {
  animation::Driver::Scratch driver;
  std::vector<double> x;  ///< m, of the vertices
};

}  // namespace truestep::blend_shapes
