// What a scene says about a skeleton: joints with their motion, goals of inverse kinematics, a skin, a motion
// file.
#pragma once
#include "engine/animation/driver_def.h"
#include "engine/core/build.h"
#include "engine/core/outputs.h"
#include "engine/kernels/animation/inverse_kinematics.h"

namespace truestep::skeleton {

struct JointDef {
  std::string id, parent;
  animation::JointKind type = animation::JointKind::ball;
  Vec3 offset, rest_rotation;  ///< m and rad (rotation vector), in the parent's frame
  Vec3 axis{0, 0, 1};
  std::optional<double> min, max, cone;
  std::optional<Vec3> end;       ///< m, of its bone where no joint follows
  std::optional<double> radius;  ///< m, of its bones
  std::string value, turn;
  std::vector<std::string> rotation;
  animation::EulerOrder order = animation::EulerOrder::xyz;
};

struct GoalDef {
  std::string id, joint, base;
  std::optional<Vec3> point;
  std::vector<std::string> target, orientation, pole;
  double weight = 1, orientation_weight = 1;
  int priority = 0;
};

struct TubeDef {
  std::string from, to;
  double radius = 0.05;
  std::optional<double> end_radius;
  int rings = 16, around = 12;
};

struct SkinDef {
  std::vector<TubeDef> tubes;
  std::vector<Vec3> vertices;
  std::vector<int64_t> triangles;
  enum class Method : uint8_t { linear, dual_quaternion } method = Method::dual_quaternion;
  double falloff = 4;
  std::optional<Vec3> color;
};

/// Feet that stand still where the motion file lets them slide.
struct FootLockDef {
  std::vector<std::string> joints;
  double height = 0.05, speed = 0.3, blend = 0.1;
};

struct MotionDef {
  std::vector<std::string> bvh;
  double scale = 1;
  std::vector<NamedText> names;
  std::optional<double> root_scale;
  animation::Extend extend = animation::Extend::clamp;
  double smoothing = 0;
  std::optional<FootLockDef> foot_lock;
};

struct SkeletonDef : animation::DriverDef {
  std::vector<JointDef> joints;
  std::vector<std::string> root_position, root_rotation;
  animation::EulerOrder root_order = animation::EulerOrder::xyz;
  std::vector<GoalDef> goals;
  animation::IkMethod solver = animation::IkMethod::damped_least_squares;
  double tolerance = 1e-4;
  int max_iterations = 100;
  enum class Elbow : uint8_t { positive, negative } elbow = Elbow::positive;
  std::optional<MotionDef> motion;
  std::optional<SkinDef> skin;
  double bone_radius = 0.03;
  enum class Publish : uint8_t { bones, skin } publish = Publish::bones;
  std::optional<Vec3> color;
};

const DefTable& skeleton_table();
const Outputs& skeleton_outputs();
Cost skeleton_cost(const void* def);

}  // namespace truestep::skeleton
