// One solid of a scene: shape, pose, motion, surface.
#pragma once
#include <string>

#include "engine/geometry/shape.h"

namespace truestep {

struct Surface {
  double restitution = 0.5;  ///< Newton's e in [0, 1]
  double friction = 0.3;     ///< Coulomb's mu >= 0
  double rest_speed = 0.01;  ///< m/s; slower approaches do not bounce
};

struct Collider {
  std::string id;
  Shape shape;
  Pose start;  ///< at t = 0
  ShapeMotion motion;
  Surface surface;
};

}  // namespace truestep
