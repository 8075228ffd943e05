// A scene's links once built: the tree, the forces in its joints, and how links are drawn.
#pragma once
#include <string>
#include <vector>

#include "engine/geometry/solid.h"
#include "engine/systems/articulation/articulation_def.h"
#include "engine/systems/articulation/closures.h"

namespace truestep::articulation {

/// No limit of a ball's swing.
inline constexpr double kNoCone = 1e30;

/// Forces between a node and its parent besides the joint's.
struct Drive {
  double damping = 0, stiffness = 0, rest = 0;
  double lowest = 0, highest = 0, limit_stiffness = 0, limit_damping = 0;
  enum class Limits : uint8_t {
    none,
    lower,
    upper,
    both
  } limits = Limits::none;  ///< for a ball: of its twist
  double cone = kNoCone;    ///< rad, for a ball's swing
  bool limited() const { return limits != Limits::none || cone < kNoCone; }
  bool anything() const { return damping > 0 || stiffness > 0 || limited(); }
};

/// Spring and damper between points of two nodes.
struct LinkSpring {
  Closure between;
  double stiffness = 0, damping = 0, rest_length = 0;
};

struct LinkShape {
  Solid solid;
  Pose pose;  ///< in the link's frame
};

struct Link {
  std::string id;
  int32_t node = kGround;    ///< its last node, which carries the mass
  int32_t parent = kGround;  ///< link
  uint32_t v = 0, velocities = 0;
  size_t def = 0;  ///< index among the scene's links
  Vec3 center;     ///< in the link's frame
};

struct Model {
  Tree tree;
  std::vector<Drive> drives;  ///< one per node
  std::vector<Closure> closures;
  std::vector<LinkSpring> springs;
  std::vector<Push> loads;  ///< constant forces and torques
  std::vector<Link> links;
  std::vector<std::vector<LinkShape>> shapes;  ///< one list per link of the scene
  std::vector<double> q, v, torque;            ///< at the start
};

/// Error "no_mass" or "bad_solid" if a link's shapes have no mass.
Model build_model(const ArticulationDef& def);

}  // namespace truestep::articulation
