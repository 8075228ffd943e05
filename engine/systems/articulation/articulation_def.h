// Parameters of the system "articulation"; units and bounds are in the table (articulation_def.cc).
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/equations/integrator_def.h"
#include "engine/core/outputs.h"
#include "engine/core/system.h"

namespace truestep::articulation {

/// Members common to all shapes of a link.
struct LinkShapeDef {
  Vec3 position, rotation;
};
struct SphereLinkDef : LinkShapeDef {
  double radius = 0.1;
};
struct BoxLinkDef : LinkShapeDef {
  Vec3 half_extents{0.1, 0.1, 0.1};
};
struct CapsuleLinkDef : LinkShapeDef {
  double radius = 0.05, half_length = 0.2;
};
struct CylinderLinkDef : LinkShapeDef {
  double radius = 0.1, half_length = 0.1;
};
using AnyLinkShapeDef = std::variant<SphereLinkDef, BoxLinkDef, CapsuleLinkDef, CylinderLinkDef>;

enum class JointType : uint8_t { revolute, prismatic, spherical, universal, cylindrical, fixed, free };

/// The number of further copies of a link, each attached to the one before.
struct LinkCopiesDef {
  int64_t count = 1;
  Vec3 offset{0, -1, 0};
};

struct LinkDef {
  std::string id;
  std::optional<std::string> parent;
  JointType joint = JointType::revolute;
  Vec3 axis{0, 0, 1}, second_axis{1, 0, 0};
  Vec3 offset, rotation;
  std::optional<double> mass;
  Vec3 center;
  std::vector<double> inertia;
  double density = 1000;
  std::vector<AnyLinkShapeDef> shapes;
  std::vector<double> q, v, torque;
  double damping = 0, stiffness = 0, rest = 0;
  std::optional<double> lowest, highest, cone;
  double limit_stiffness = 1000, limit_damping = 0;
  Vec3 force, moment;
  enum class Axes : uint8_t { world, link } force_frame = Axes::world;
  std::optional<LinkCopiesDef> copies;
};

/// Two points that coincide.
struct ClosureDef {
  std::string a, b = "ground";
  Vec3 point_a, point_b;
};

/// Spring and damper between two points.
struct LinkSpringDef {
  std::string a, b = "ground";
  Vec3 point_a, point_b;
  double stiffness = 1000, damping = 0, rest_length = 0;
};

struct ArticulationDef : IntegratorParams {
  std::vector<LinkDef> links;
  std::vector<ClosureDef> closures;
  std::vector<LinkSpringDef> springs;
  std::optional<Vec3> gravity;
  std::optional<double> point_radius;
  std::optional<Vec3> color;
};

/// Numbers of a joint in q and in v.
constexpr size_t joint_positions(JointType j) {
  constexpr size_t kCount[] = {1, 1, 4, 2, 2, 0, 7};
  return kCount[static_cast<size_t>(j)];
}
constexpr size_t joint_velocities(JointType j) {
  constexpr size_t kCount[] = {1, 1, 3, 2, 2, 0, 6};
  return kCount[static_cast<size_t>(j)];
}

const DefTable& articulation_table();
/// The outputs of the system.
const Outputs& articulation_outputs();
std::unique_ptr<const System> build_articulation(const void* def, const BuildContext& context);
Cost articulation_cost(const void* def);

}  // namespace truestep::articulation
