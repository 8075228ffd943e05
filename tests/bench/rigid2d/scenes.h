// Engine-independent scenes of rigid bodies in the plane, and measures of how well a state satisfies them:
// the published set of the Box2D v3 benchmark (density 1, friction 0.6, gravity -10, steps of 1/60 s).
#pragma once
#include <array>
#include <string>
#include <vector>

namespace truestep::bench {

/// Box of half edges about (cx, cy); hy = 0: a segment, hx = 0: a disk of radius hy. With corners (four,
/// counter-clockwise): their convex hull.
struct FlatShape {
  double hx, hy, cx = 0, cy = 0, density = 1;
  std::vector<std::array<double, 2>> corners = {};
};
/// `dynamic` bodies may sleep if the engine is told to let them, `sleeper` bodies always may, and `asleep`
/// ones are sleepers that sleep from the start.
struct FlatBody {
  enum class Kind { fixed, dynamic, sleeper, asleep } kind = Kind::dynamic;
  double x = 0, y = 0, vx = 0;
  std::vector<FlatShape> shapes = {};
  double angle = 0, spin = 0;
};
/// Revolute; anchors in the bodies' frames. A torque above 0 is a motor.
struct FlatJoint {
  int a, b;
  double ax, ay, bx, by, speed = 0, torque = 0;
};
struct FlatScene {
  std::string name;
  std::vector<FlatBody> bodies = {};
  std::vector<FlatJoint> joints = {};
  double gravity = -10;
  bool collide = true;
  int steps = 200;
  int settle = 0;  ///< steps before the measurement of standing begins
  size_t top = 0;  ///< body whose drift and sinking are reported; 0: the largest of all bodies
};
struct FlatPose {
  double x, y, angle;
};
struct FlatState {
  FlatPose pose;
  double vx, vy, spin;
};
inline constexpr double kFlatFriction = 0.6, kFlatDt = 1.0 / 60;

std::vector<FlatScene> flat_scenes();
/// Structures that should stand: large pyramid, stacks of 10, 20 and 50, an arch, a house of cards, a heap.
std::vector<FlatScene> standing_flat_scenes();
FlatScene flat_stack(int boxes);
struct FlatMass {
  double mass = 0, inertia = 0;  ///< inertia about the origin of the body's frame, its centre
};
FlatMass flat_mass(const FlatBody& body);
double flat_kinetic(const FlatScene& scene, const std::vector<FlatState>& state);
/// Deepest overlap of any two bodies (m), or the widest gap of any joint where nothing collides.
double flat_error(const FlatScene& scene, const std::vector<FlatPose>& poses);

}  // namespace truestep::bench
