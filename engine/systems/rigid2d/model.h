// A scene's bodies, shapes and joints as the solver uses them: bodies with their origin at the centre of
// mass, inverse masses, local anchors. Built once and constant afterwards.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/collision/flat/outline.h"
#include "engine/systems/rigid2d/rigid2d_def.h"

namespace truestep::rigid2d {

using flat::Outline;
using flat::Pose;
using flat::Rotation;
using flat::Vec2;

struct Body {
  Motion motion = Motion::fixed;
  double inverse_mass = 0, inverse_inertia = 0;  ///< 1/kg, 1/(kg m^2); 0 unless dynamic
  double mass = 0, inertia = 0;
  Vec2 force;                ///< N, constant
  double torque = 0;         ///< N m
  bool force_turns = false;  ///< turns with the body
  double friction = 0, restitution = 0, rolling_resistance = 0, surface_speed = 0;
  double linear_damping = 0, angular_damping = 0, gravity_scale = 1;
  double reach = 0, inner = 0;  ///< m: distance from the centre to the farthest surface, radius of the
                                ///< largest inscribed circle
  bool fixed_rotation = false, sensor = false, bullet = false, asleep = false, can_sleep = true;
  bool one_way = false;
  Vec2 one_way_direction;
  int32_t group = 0;
  uint32_t category = 1, mask = ~0u;
  Vec2 position, velocity;  ///< of the centre of mass at t = 0
  double angle = 0, angular_velocity = 0;
  uint32_t first_shape = 0, shapes = 0;
  std::optional<Vec3> color;
};

struct Shape {
  Outline outline;  ///< about the body's centre of mass
  uint32_t body = 0;
};

/// The data that every step reads for many bodies, compact in memory.
struct Light {
  double reach = 0, inner = 0, mass = 0;
  uint32_t category = 1, mask = ~0u;
  int32_t group = 0;
  Motion motion = Motion::fixed;
  bool sensor = false, bullet = false, one_way = false, can_sleep = true;
  bool hung = false;     ///< an unbreakable joint ties it to a body that does not move
  bool jointed = false;  ///< some joint is on it
};
struct Dynamics {
  double inverse_mass = 0, inverse_inertia = 0, linear_damping = 0, angular_damping = 0, gravity_scale = 1;
};
struct Surface {
  double friction = 0, restitution = 0, rolling_resistance = 0, speed = 0;
};

enum class JointKind : uint8_t { revolute, prismatic, distance, weld, wheel, motor, mouse, gear, pulley };

inline constexpr uint32_t kNoMotor = 0xffffffff;

struct Joint {
  JointKind kind = JointKind::revolute;
  uint32_t a = 0, b = 0;  ///< bodies; the last one is the world
  Vec2 local_a, local_b;  ///< anchors about the centres of mass
  Vec2 axis;              ///< unit, in the frame of a
  double angle = 0;       ///< rad, angle of b relative to a that counts as 0
  bool has_motor = false, has_spring = false, has_lower = false, has_upper = false;
  bool has_target = false;  ///< the motor goes to a position instead of at a speed
  double lower = 0, upper = 0, motor_speed = 0, max_motor = 0;
  double motor_target = 0, motor_rate = 0;  ///< m or rad; 1/s, also of a motor joint
  /// A motor joint: what it drives at a velocity instead of to a pose.
  bool at_velocity = false, at_spin = false;
  Vec2 move;                      ///< m or m/s at t = 0, in the frame of a
  double spin = 0, turn = 0;      ///< rad/s, rad
  uint32_t motor_row = kNoMotor;  ///< in the state
  double hertz = 0, damping_ratio = 1;
  double stiffness = 0,
         damping = 0;  ///< of the spring, for these two bodies: N/m, N s/m or N m/rad, N m s/rad
  double rest = 0;     ///< m or rad, coordinate at which the spring is at rest
  double length = 0, ratio = 1;
  Vec2 ground_a, ground_b;  ///< wheels of a pulley, target of a mouse
  double max_force = 0, max_torque = 0;
  double break_force = 0, break_torque = 0;  ///< N, N m; 0: it does not break
  bool collide = false;

  bool may_break() const { return break_force > 0 || break_torque > 0; }
  /// True for a spring between two points without limits.
  bool spring_only() const { return kind == JointKind::distance && has_spring && !has_lower && !has_upper; }
  /// True for a joint that only holds two points together: solved in packs with others of its kind.
  bool plain() const {
    return kind == JointKind::revolute && !has_motor && !has_spring && !has_lower && !has_upper;
  }
};

/// A joint that only holds two points together, as the packs read it.
struct Hinge {
  uint32_t joint = 0, a = 0, b = 0;
  Vec2 local_a, local_b;
};

/// Sets stiffness and damping of a spring given by its frequency, for the bodies' pose at t = 0.
void stiffen_by_frequency(Joint& j, const Body& a, const Body& b);

struct Model {
  std::vector<Body> bodies;  ///< the last one is the world (fixed, no shapes)
  std::vector<Light> light;  ///< same order as bodies, as are the next two
  std::vector<Dynamics> dynamics;
  std::vector<Surface> surfaces;
  std::vector<uint32_t> body_of;  ///< body of every shape, as are the radii (m)
  std::vector<double> radius;
  std::vector<Hinge> hinges;     ///< the plain joints
  std::vector<uint32_t> others;  ///< the joints that are not plain
  std::vector<uint32_t> motors;  ///< the joints with a motor
  bool may_break = false;        ///< some joint has a break_force or a break_torque
  std::vector<uint32_t> forced;  ///< bodies with a constant force or torque
  std::vector<Shape> shapes;
  std::vector<Joint> joints;
  std::vector<std::pair<uint32_t, std::string>> names;  ///< joints with an id
  std::vector<uint64_t> not_touching;  ///< (a << 32 | b), a < b, ascending: joined bodies that do not collide
  double margin = 0.02;                ///< m, distance at which contacts become speculative
  double size = 1;                     ///< m, typical size of a body
  double thinnest = HUGE_VAL;          ///< m, least inner radius of a dynamic body that touches others
  bool seams = false;                  ///< fixed polygons may be one surface (solver/seams.h)

  uint32_t world() const { return static_cast<uint32_t>(bodies.size() - 1); }
  size_t count() const { return bodies.size() - 1; }
};

/// Throws Error "scene_invalid" for a shape that cannot be built.
Model build_model(const Rigid2dDef& def);

}  // namespace truestep::rigid2d
