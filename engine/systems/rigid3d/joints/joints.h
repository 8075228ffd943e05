// Joints between bodies, as built from the scene. A joint has up to six rows: three translations along axes
// of a and three rotations. The coordinate of a locked row is 0; others may be limited, sprung or driven, and
// are listed as drives. Rows of the state hold the bodies of each joint, its loads, how far its drives have
// turned and whether it is broken.
#pragma once
#include <array>
#include <limits>
#include <vector>

#include "engine/systems/rigid3d/bodies.h"

namespace truestep::rigid3d {

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Limits, spring and motor of one row of a joint.
struct Drive {
  uint32_t joint = 0;
  uint32_t row = 0;  ///< 0 to 2: slides, 3 to 5: turns
  enum Law : uint32_t { kSpring = 1, kMotor = 2, kLower = 4, kUpper = 8 };
  uint32_t laws = 0;
  double lower = 0, upper = 0;
  double rest = 0;                          ///< coordinate of the spring
  double stiffness = 0, damping = 0;        ///< spring: N/m and N s/m, or N m/rad and N m s/rad
  double frequency = 0, damping_ratio = 0;  ///< rad/s; define stiffness and damping where not 0
  enum class Wants : uint8_t { speed, place } wants = Wants::speed;
  double motor_target = 0;
  /// N or N m; of a pose, whose rows 0 to 2 and 3 to 5 are each limited together, the same in all three.
  double max_motor = kUnbounded;
  double servo_rate = 0;  ///< 1/s, rate at which a motor approaches its target
};

struct Joint {
  enum class Form : uint8_t { free, locked, hinge, cardan, swing_twist, line, pose, gear };
  std::string id;
  std::array<uint32_t, 2> bodies;  ///< rows at t = 0, kNoBody: the world
  Vec3 anchor_a, anchor_b;         ///< m, in the bodies' frames
  Quat slide_frame;                ///< axes of the linear rows, in a's frame
  Quat turn_a, turn_b;             ///< axes of the angular rows in both, the same at t = 0
  std::array<uint8_t, 6> locked{};
  /// How the angular rows are measured: not at all, as the rotation vector (locked, pose), about the first
  /// axis (hinge), as Cardan angles, as twist and swing; `line` has one row along the line between the
  /// anchors.
  Form form = Form::free;
  double length = 0;  ///< m, of a line
  uint32_t first_drive = 0, drives = 0;
  double break_force = kUnbounded, break_torque = kUnbounded;
  bool collide = false;
  /// A gear: coordinates of two drives, first + ratio second = 0.
  std::array<uint32_t, 2> geared{};
  double ratio = 1;
  /// Has only springs.
  bool springs_only = false;
};

struct JointList {
  std::vector<Joint> joints;
  std::vector<Drive> drives;
};

/// All joints of the scene. Throws Error "scene_invalid" with pointers to missing or unsuitable bodies and
/// joints.
JointList build_joints(const Rigid3dDef& def, const BodyList& bodies);

/// Sets stiffness and damping of springs that are given by frequency, for the bodies' pose at t = 0.
void stiffen_by_frequency(JointList& joints, const BodyList& bodies);

/// Current geometry of a joint.
struct JointPlace {
  Vec3 arm_a, arm_b;     ///< m, from the centres to the anchors
  Vec3 gap;              ///< x_b + arm_b - x_a - arm_a
  Vec3 axes[3];          ///< of the linear rows
  Vec3 turns[3];         ///< turn . (w_b - w_a) is the rate of an angular coordinate
  double coordinate[6];  ///< m and rad; turns between -pi and pi
};
JointPlace joint_place(const Joint& joint, const Pose& a, const Pose& b);

/// The angle equal to `angle` modulo 2 pi that is closest to `near` (rad).
double unwrapped(double angle, double near);

}  // namespace truestep::rigid3d
