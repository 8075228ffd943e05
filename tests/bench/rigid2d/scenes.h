// Scenes of rigid bodies in the plane that say nothing about engines, and how well a state keeps them: the
// published set of the Box2D v3 benchmark (density 1, friction 0.6, gravity -10, steps of 1/60 s).
#pragma once
#include <string>
#include <vector>

namespace truestep::bench {

/// Box of half edges about (cx, cy); hy = 0: a segment, hx = 0: a disk of radius hy.
struct FlatShape {
  double hx, hy, cx = 0, cy = 0, density = 1;
};
struct FlatBody {
  enum class Kind { fixed, dynamic, asleep } kind = Kind::dynamic;
  double x = 0, y = 0, vx = 0;
  std::vector<FlatShape> shapes;
};
/// Revolute; anchors in the bodies' frames. A torque above 0 is a motor.
struct FlatJoint {
  int a, b;
  double ax, ay, bx, by, speed = 0, torque = 0;
};
struct FlatScene {
  std::string name;
  std::vector<FlatBody> bodies;
  std::vector<FlatJoint> joints;
  double gravity = -10;
  bool collide = true;
  int steps = 200;
};
struct FlatPose {
  double x, y, angle;
};

std::vector<FlatScene> flat_scenes();
/// Deepest overlap of any two bodies (m), or the widest gap of any joint where nothing collides.
double flat_error(const FlatScene& scene, const std::vector<FlatPose>& poses);

}  // namespace truestep::bench
