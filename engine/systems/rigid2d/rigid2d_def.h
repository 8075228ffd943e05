// Parameters of the system "rigid2d"; units and bounds are in the table (rigid2d_def.cc).
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/core/def/def.h"
#include "engine/core/outputs.h"

namespace truestep::rigid2d {

struct CircleDef {
  double radius = 0.5;
  Vec3 center;
};
struct CapsuleDef {
  Vec3 from{-0.5, 0, 0}, to{0.5, 0, 0};
  double radius = 0.25;
};
struct BoxDef {
  Vec3 half_extents{0.5, 0.5, 0}, center;
  double angle = 0, radius = 0;
};
struct PolygonDef {
  std::vector<Vec3> points;
  double radius = 0;
};
struct ChainDef {
  std::vector<Vec3> points;
  bool loop = false;
  enum class Sides : uint8_t { both, left, right, outside, inside } sides = Sides::both;
};
using ShapeDef = std::variant<CircleDef, CapsuleDef, BoxDef, PolygonDef, ChainDef>;

enum class Motion : uint8_t { dynamic, kinematic, fixed };

struct BodyDef {
  std::string id;
  Motion motion = Motion::dynamic;
  Vec3 position, velocity;
  double angle = 0, angular_velocity = 0;
  std::vector<ShapeDef> shapes;
  double density = 1000;
  std::optional<double> mass, inertia;
  Vec3 force;
  double torque = 0;
  enum class Axes : uint8_t { world, body } force_frame = Axes::world;
  std::optional<double> friction, restitution, rolling_resistance;
  double surface_speed = 0;
  double linear_damping = 0, angular_damping = 0, gravity_scale = 1;
  bool fixed_rotation = false, sensor = false, bullet = false, asleep = false, can_sleep = true;
  std::optional<Vec3> one_way, color;
  int64_t group = 0, category = 1, mask = 0xffffffff;
};

struct GridDef {
  BodyDef body;
  Vec3 origin, spacing{1, 1, 0};
  int64_t nx = 10, ny = 10;
  bool joined = false;
  std::vector<int64_t> held;
};
struct PyramidDef {
  BodyDef body;
  Vec3 origin, spacing{1, 1, 0};
  int64_t base = 10;
};
struct WallDef {
  BodyDef body;
  Vec3 origin, spacing{1, 1, 0};
  int64_t nx = 10, ny = 10;
};
struct BodyChainDef {
  BodyDef body;
  Vec3 from, to{5, 0, 0};
  int64_t links = 10;
  double radius = 0.1;
  enum class Held : uint8_t { none, first, both } held = Held::first;
};
using GeneratorDef = std::variant<GridDef, PyramidDef, WallDef, BodyChainDef>;

/// Parameters common to all joints. Body -1 is the world.
struct JointDef {
  std::string id;
  int64_t a = -1, b = 0;
  std::optional<Vec3> anchor;
  std::optional<double> break_force, break_torque;
  bool collide = false;
};
/// Limits, spring and motor of one degree of freedom: m and N, or rad and N m.
struct Drive {
  std::optional<double> lower, upper;
  std::optional<double> stiffness, damping, hertz;
  double damping_ratio = 1, rest = 0;
  std::optional<double> motor_speed, motor_target, max_motor;
  double motor_rate = 10;
};
struct RevoluteDef : JointDef, Drive {};
struct PrismaticDef : JointDef, Drive {
  Vec3 axis{1, 0, 0};
};
struct WheelDef : JointDef, Drive {
  Vec3 axis{0, 1, 0};
  WheelDef() { damping_ratio = 0.7; }
};
struct DistanceDef : JointDef {
  std::optional<Vec3> anchor_b;
  std::optional<double> length, minimum, maximum, hertz;
  double damping_ratio = 0;
};
struct SpringDef : JointDef {
  std::optional<Vec3> anchor_b;
  std::optional<double> length, stiffness, damping, hertz;
  double damping_ratio = 0;
};
struct WeldDef : JointDef {
  std::optional<double> hertz;
  double damping_ratio = 1;
};
struct MotorDef : JointDef {
  Vec3 move;
  std::optional<Vec3> velocity;
  std::optional<double> angular_velocity;
  double turn = 0, rate = 10, max_force = 1000, max_torque = 1000;
};
struct MouseDef : JointDef {
  Vec3 target;
  double hertz = 5, damping_ratio = 0.7;
  std::optional<double> max_force;
};
struct GearDef : JointDef {
  double ratio = 1;
};
struct PulleyDef : JointDef {
  std::optional<Vec3> anchor_b;
  Vec3 ground_a, ground_b;
  double ratio = 1;
};
using AnyJointDef = std::variant<RevoluteDef, PrismaticDef, DistanceDef, SpringDef, WeldDef, WheelDef,
                                 MotorDef, MouseDef, GearDef, PulleyDef>;

enum class Precision : uint8_t { f32, f64 };

struct Rigid2dDef {
  std::vector<BodyDef> bodies;
  std::vector<GeneratorDef> generators;
  std::vector<AnyJointDef> joints;
  enum class Engine : uint8_t { truestep, box2d } engine = Engine::truestep;
  std::optional<Vec3> gravity;
  int64_t substeps = 4;
  Precision precision = Precision::f32;
  std::optional<double> contact_hertz, joint_hertz, contact_margin;
  double contact_damping_ratio = 20, joint_damping_ratio = 2, push_out_speed = 3;
  double friction = 0.5, restitution = 0, rolling_resistance = 0;
  std::optional<double> restitution_speed;
  bool sleeping = true;
  double sleep_speed = 0.05, sleep_time = 0.5;
  std::optional<Vec3> color;
};

const DefTable& rigid2d_table();
/// Fields and observables of the system.
const Outputs& rigid2d_outputs();

/// Numbers of bodies and joints that the generators add to the listed ones.
struct Counts {
  double bodies = 0, shapes = 0, joints = 0;
  double moving_shapes = 0;  ///< of the shapes
};
Counts counts(const Rigid2dDef& def);

}  // namespace truestep::rigid2d
