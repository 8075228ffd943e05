// Scene parameters of a skeleton: joints with their motion, goals of inverse kinematics, a skin, a motion
// file.
#pragma once
#include "engine/animation/driver_def.h"
#include "engine/core/def/build.h"
#include "engine/core/outputs.h"
#include "engine/kernels/animation/inverse_kinematics.h"
#include "engine/kernels/animation/skinning.h"

namespace truestep::skeleton {

struct JointDef {
  std::string id, parent;
  animation::JointKind type = animation::JointKind::ball;
  Vec3 offset, rest_rotation;  ///< m and rad (rotation vector), in the parent's frame
  Vec3 axis{0, 0, 1};
  std::optional<double> min, max, cone;
  std::optional<Vec3> end;       ///< m, end of its bone if no joint follows
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
  enum class Source : uint8_t { scene, motion_file } source = Source::scene;
  std::vector<animation::SkinWeights> file_weights;  ///< of `vertices`, if a file gave them
};

/// Locks feet in place where the motion file lets them slide.
struct FootLockDef {
  std::vector<std::string> joints;
  double height = 0.05, speed = 0.3, blend = 0.1;
};

struct PlacementDef {
  std::string marker, joint;
  Vec3 point;
};
struct CameraDef {
  std::string name;
  Vec3 position, target, up{0, 1, 0};
  double focal = 1000, middle_u = 0, middle_v = 0;
};
/// Optical markers, in a file or in pictures.
struct MarkersDef {
  std::vector<std::string> trc;
  std::vector<CameraDef> cameras;
  std::vector<std::string> images;
  double rate = 60;
  std::vector<PlacementDef> placements;
};

struct MotionDef {
  std::vector<std::string> bvh, gltf;
  std::string animation;
  double rate = 30;
  std::optional<MarkersDef> markers;
  double scale = 1;
  std::vector<NamedText> names;
  std::optional<double> root_scale;
  animation::Extend extend = animation::Extend::clamp;
  double smoothing = 0;
  std::optional<FootLockDef> foot_lock;
};

/// A recorded motion layered over what comes before it.
struct LayerDef {
  MotionDef motion;
  std::string weight;
  enum class Mode : uint8_t { cross_fade, additive } mode = Mode::cross_fade;
};

/// Poses that goals prefer.
struct PriorDef {
  MotionDef motion;
  int components = 6;
  double variation = 0.02, spread = 0.001;
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
  std::vector<LayerDef> layers;
  std::optional<PriorDef> prior;
  std::optional<SkinDef> skin;
  double bone_radius = 0.03;
  enum class Publish : uint8_t { bones, skin } publish = Publish::bones;
  std::optional<Vec3> color;
};

const DefTable& skeleton_table();
/// The same table for scenes of inverse kinematics, which need goals, and of recorded motion.
const DefTable& ik_table();
const DefTable& motion_capture_table();
const Outputs& skeleton_outputs();
Cost skeleton_cost(const void* def);

}  // namespace truestep::skeleton
