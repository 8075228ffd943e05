// Parameters of the system "rigid3d"; units and bounds are in the table (rigid3d_def.cc).
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/outputs.h"
#include "engine/core/system.h"
#include "engine/geometry/mass_properties.h"
#include "engine/systems/rigid3d/joints/joint_def.h"

namespace truestep::rigid3d {

/// Copies of a body: positions on a lattice, in rows of decreasing length, or on a circle.
struct CopiesDef {
  enum class Layout : uint8_t { grid, wall, pyramid, circle } layout = Layout::grid;
  std::vector<int64_t> count{1, 1, 1};
  Vec3 spacing{1, 1, 1};
  double radius = 1;
  double jitter = 0;
  enum class Turn : uint8_t { none, random, outward } turn = Turn::none;
};

/// Parameters common to bodies of all shapes.
struct BodyDef {
  std::string id;
  enum class Motion : uint8_t { dynamic, fixed, kinematic } motion = Motion::dynamic;
  Vec3 position, axis{0, 1, 0};
  double angle = 0;
  std::vector<double> orientation;
  Vec3 velocity, angular_velocity;
  double density = 1000;
  std::optional<double> mass;
  std::vector<double> inertia;
  Vec3 force, torque;
  enum class Axes : uint8_t { world, body } force_frame = Axes::world;
  double linear_damping = 0, angular_damping = 0, gravity_scale = 1;
  std::optional<double> friction, restitution, rolling_resistance, spinning_resistance;
  Vec3 surface_velocity;
  int64_t group = 0, category = 1, mask = 0xffffffff;
  bool fixed_rotation = false, sensor = false, asleep = false, can_sleep = true;
  std::optional<Vec3> one_way, color;
  std::optional<CopiesDef> copies;
};

struct SphereBodyDef : BodyDef {
  double radius = 0.5;
};
struct BoxBodyDef : BodyDef {
  Vec3 half_extents{0.5, 0.5, 0.5};
};
struct CapsuleBodyDef : BodyDef {
  double radius = 0.25, half_length = 0.5;
};
struct CylinderBodyDef : BodyDef {
  double radius = 0.5, half_length = 0.5;
};
struct HullBodyDef : BodyDef {
  std::vector<Vec3> points;
};
struct MeshBodyDef : BodyDef {
  std::vector<Vec3> vertices;
  std::vector<int64_t> triangles;
};
struct HeightFieldBodyDef : BodyDef {
  std::vector<int64_t> count{2, 2};
  double spacing = 1;
  std::vector<double> heights;
};
struct PlaneBodyDef : BodyDef {
  Vec3 normal{0, 1, 0};
};

/// A convex part of a compound.
struct PartDef {
  Vec3 position, axis{0, 1, 0};
  double angle = 0;
};
struct SpherePartDef : PartDef {
  double radius = 0.5;
};
struct BoxPartDef : PartDef {
  Vec3 half_extents{0.5, 0.5, 0.5};
};
struct CapsulePartDef : PartDef {
  double radius = 0.25, half_length = 0.5;
};
struct CylinderPartDef : PartDef {
  double radius = 0.5, half_length = 0.5;
};
struct HullPartDef : PartDef {
  std::vector<Vec3> points;
};
using AnyPartDef = std::variant<SpherePartDef, BoxPartDef, CapsulePartDef, CylinderPartDef, HullPartDef>;
struct CompoundBodyDef : BodyDef {
  std::vector<AnyPartDef> parts;
};

using AnyBodyDef = std::variant<SphereBodyDef, BoxBodyDef, CapsuleBodyDef, CylinderBodyDef, HullBodyDef,
                                MeshBodyDef, HeightFieldBodyDef, PlaneBodyDef, CompoundBodyDef>;

struct Rigid3dDef {
  std::vector<AnyBodyDef> bodies;
  std::vector<AnyJointDef> joints;
  enum class Engine : uint8_t { truestep, bullet } engine = Engine::truestep;
  std::optional<Vec3> gravity;
  int64_t substeps = 5;
  enum class Precision : uint8_t { f32, f64 } precision = Precision::f32;
  double friction = 0.5, restitution = 0;
  std::optional<double> restitution_speed;
  double rolling_resistance = 0;
  std::optional<double> spinning_resistance;
  std::optional<double> contact_hertz;
  double contact_damping_ratio = 10, push_out_speed = 3;
  bool sleeping = true;
  double sleep_speed = 0.05, sleep_time = 0.5;
};

const DefTable& rigid3d_table();
/// Fields and observables of the system.
const Outputs& rigid3d_outputs();
std::unique_ptr<const System> build_rigid3d(const void* def, const BuildContext& context);
Cost rigid3d_cost(const void* def);

/// Members common to all alternatives.
inline const BodyDef& common(const AnyBodyDef& d) {
  return std::visit([](const auto& b) -> const BodyDef& { return b; }, d);
}
/// Tensor from the three or six numbers of "inertia".
inline Symmetric3 inertia_of(const std::vector<double>& I) {
  return I.size() == 6 ? Symmetric3{I[0], I[1], I[2], I[3], I[4], I[5]} : Symmetric3{I[0], I[1], I[2]};
}
/// Number of bodies that a def stands for; a double, which cannot overflow.
double body_count(const BodyDef& d);

}  // namespace truestep::rigid3d
