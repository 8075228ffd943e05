// A skeleton as built from a scene: joints, their drives, bones, skin, goals.
#pragma once
#include <array>

#include "engine/animation/driver.h"
#include "engine/geometry/solid.h"
#include "engine/kernels/animation/skinning.h"
#include "engine/systems/skeleton/skeleton_def.h"

namespace truestep::skeleton {

/// Outputs of the driver that move a joint; none: it keeps its coordinates, which goals change.
struct JointDrive {
  enum class Kind : uint8_t { kept, value, rotation, turn } kind = Kind::kept;
  size_t output = 0;  ///< the first of one or three, or a turn
  animation::EulerOrder order = animation::EulerOrder::xyz;
};

struct Bone {
  uint32_t joint = 0;
  Vec3 end;           ///< m, in the joint's frame
  double radius = 0;  ///< m
};

struct GoalDrive {
  std::string id;
  animation::IkGoal goal;
  size_t target = 0, orientation = 0, pole = 0;
  bool has_orientation = false, has_pole = false;
};

struct Model {
  std::vector<std::string> ids;
  std::vector<animation::Joint> joints;
  std::vector<JointDrive> drives;
  size_t root_position = 0, root_rotation = 0;
  animation::EulerOrder root_order = animation::EulerOrder::xyz;
  std::vector<Bone> bones;
  std::vector<GoalDrive> goals;
  std::vector<Pose> rest;  ///< of the joints, all coordinates 0

  std::vector<Vec3> skin;  ///< m, at rest
  std::vector<animation::SkinWeights> weights;
  std::vector<std::array<uint32_t, 3>> triangles;

  std::optional<size_t> find(const std::string& id) const;
};

/// Faults are reported to the driver.
Model build_model(const SkeletonDef& def, animation::Driver& driver);
/// Vertices, triangles and weights; after build_model.
void build_skin(const SkinDef& def, Model& model, animation::Driver& driver);

}  // namespace truestep::skeleton
