// Engine-independent scenes of rigid bodies in space, and measures of how well a state satisfies them: z up,
// density 1000, friction 0.5, no restitution, no damping, no sleep, steps of 1/60 s.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "engine/geometry/solid.h"

namespace truestep::bench {

/// Box: half edges; sphere: radius; capsule along y: radius, half length; prism along y: the corners x, z of
/// its cross-section about their centroid, with a principal axis along x, and half its length in size.y.
struct SpaceBody {
  enum class Shape { box, sphere, capsule, prism } shape = Shape::box;
  Vec3 size{0.5, 0.5, 0.5};
  Pose pose = {};
  Vec3 angular_velocity = {};
  bool fixed = false;
  Vec3 velocity = {};
  std::vector<std::array<double, 2>> corners = {};
};
/// Ball joint between bodies that start unrotated; its position at the start.
struct SpaceJoint {
  int a, b;
  Vec3 anchor;
};
struct SpaceScene {
  std::string name;
  std::vector<SpaceBody> bodies = {};
  std::vector<SpaceJoint> joints = {};
  Vec3 gravity{0, 0, -9.81};
  bool collide = true;
  int steps = 600;
  int substeps = 0;  ///< of ours; 0: the default
  int settle = 0;    ///< steps before the measurement of standing begins
  size_t top = 0;    ///< body whose drift and sinking are reported; 0: the largest of all bodies
};
struct SpaceState {
  Pose pose;
  Vec3 velocity, angular_velocity;
};

inline constexpr double kSpaceDensity = 1000, kSpaceFriction = 0.5;

SpaceScene space_stack(int boxes, int steps);
/// Pyramid 15, pile 20, wall 40, joint grid 45, stacks of 10 and 20, a free top, the pyramid in 4 small
/// steps.
std::vector<SpaceScene> space_scenes();

/// Structures that should stand: wall 40, pyramid 15, stacks of 10, 20 and 50, an arch, a house of cards, a
/// round tower of bricks, a heap.
std::vector<SpaceScene> standing_space_scenes();

double mass(const SpaceBody& body);
Vec3 moments(const SpaceBody& body);
/// Corners of a prism in its frame.
std::vector<Vec3> prism_points(const SpaceBody& body);
/// For any shape but prisms.
Solid solid(const SpaceBody& body);
/// Kinetic and potential energy (J).
struct SpaceEnergy {
  double kinetic = 0, potential = 0;
};
SpaceEnergy energy(const SpaceScene& scene, const std::vector<SpaceState>& state);
/// Deepest overlap of any two bodies (m).
double deepest(const SpaceScene& scene, const std::vector<SpaceState>& state);
/// Widest gap of any joint (m).
double widest(const SpaceScene& scene, const std::vector<SpaceState>& state);
/// Angle (rad) between a free body's orientation after t seconds and the exact one.
double turn_error(const SpaceBody& start, const SpaceState& now, double t);

}  // namespace truestep::bench
