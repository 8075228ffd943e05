// Parameters of joints between rigid bodies; units and bounds are in the tables (joint_def.cc).
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/core/def/def.h"

namespace truestep::rigid3d {

/// Parameters common to all joints. Body -1 is the world.
struct JointDef {
  std::string id;
  int64_t a = -1, b = 0;
  std::optional<Vec3> anchor;
  std::optional<double> break_force, break_torque;
  bool collide = false;
  int64_t repeat = 1, step = 1;
  Vec3 offset;
};

/// Limits, spring and motor of one degree of freedom: m and N, or rad and N m.
struct DriveDef {
  std::optional<double> lower, upper;
  std::optional<double> stiffness, damping, hertz;
  double damping_ratio = 1, rest = 0;
  std::optional<double> motor_speed, motor_target, max_motor;
  double motor_rate = 10;
};
struct SlideDriveDef : DriveDef {};
struct TurnDriveDef : DriveDef {};

struct BallJointDef : JointDef {};
struct FixedJointDef : JointDef {};
struct HingeJointDef : JointDef, TurnDriveDef {
  Vec3 axis{0, 1, 0};
};
struct SliderJointDef : JointDef, SlideDriveDef {
  Vec3 axis{0, 1, 0};
};
struct CylindricalJointDef : JointDef {
  Vec3 axis{0, 1, 0};
  std::optional<SlideDriveDef> slide;
  std::optional<TurnDriveDef> turn;
};
struct PlaneJointDef : JointDef {
  Vec3 axis{0, 1, 0};
};
struct DistanceJointDef : JointDef {
  std::optional<Vec3> anchor_b;
  std::optional<double> length, minimum, maximum;
};
struct SpringJointDef : JointDef {
  std::optional<Vec3> anchor_b;
  std::optional<double> length, stiffness, damping, hertz;
  double damping_ratio = 0;
};
struct UniversalJointDef : JointDef {
  Vec3 axis{1, 0, 0}, axis_b{0, 0, 1};
  std::optional<TurnDriveDef> turn, turn_b;
};
struct ConeTwistJointDef : JointDef {
  Vec3 axis{0, 1, 0};
  std::optional<double> swing, twist_lower, twist_upper;
};
struct SixDofJointDef : JointDef {
  Vec3 axis{1, 0, 0};
  std::optional<Vec3> across;
  std::optional<SlideDriveDef> x, y, z;
  std::optional<TurnDriveDef> turn_x, turn_y, turn_z;
};
struct MotorJointDef : JointDef {
  Vec3 move, turn;
  std::optional<Vec3> velocity, angular_velocity;
  double rate = 10;
  double max_force = 1000, max_torque = 1000;
};
/// Couples the coordinates of two other joints.
struct GearJointDef {
  std::string id;
  int64_t first = 0, second = 1;
  double ratio = 1;
};

using AnyJointDef =
    std::variant<BallJointDef, FixedJointDef, HingeJointDef, SliderJointDef, CylindricalJointDef,
                 PlaneJointDef, DistanceJointDef, SpringJointDef, UniversalJointDef, ConeTwistJointDef,
                 SixDofJointDef, MotorJointDef, GearJointDef>;

/// Maximum number of joints, and of bodies that they may refer to.
inline constexpr double kMostJoints = 1'000'000;

/// The tables of AnyJointDef's alternatives, in their order.
std::vector<NamedTable> joint_tables();
/// Number of joints that an entry stands for.
int64_t joint_count(const AnyJointDef& d);
/// Id of the entry; empty if it has none.
const std::string& joint_id(const AnyJointDef& d);

}  // namespace truestep::rigid3d
