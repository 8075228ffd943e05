// The system type "skeleton": a tree of joints whose coordinates come from expressions, keys or a motion file
// and are then adjusted by goals of inverse kinematics (kernels/animation). Joints without a drive keep their
// coordinates from step to step, so a solver continues from its last solution. Its bones are capsules,
// published as kinematic bodies with the velocities of their motion; or its skin is published as triangles.
// Parts: the joints, bones, skin. Commands: set_parameter of a control; drag of a joint to a position, which
// is a goal for all joints above it, and release.
#pragma once
#include <memory>

#include "engine/animation/moved_bodies.h"
#include "engine/core/outputs/tabled.h"
#include "engine/core/ports/rig_port.h"
#include "engine/core/system.h"
#include "engine/kernels/animation/pose_prior.h"
#include "engine/systems/skeleton/clip.h"
#include "engine/systems/skeleton/markers.h"

namespace truestep::skeleton {

/// Columns of a state after those of the bones, in their order.
struct SkeletonColumns {
  enum Index : State::Column {
    kControl = animation::MovedBodies::kCount,
    kJointPosition,     ///< m
    kJointVelocity,     ///< m/s
    kJointOrientation,  ///< w x y z
    kCoordinates,       ///< value (rad or m), turn (w x y z), shift (m); more rows if bodies lead it
    kDragJoint,         ///< -1: none
    kDragTarget,        ///< m
    kSolved,            ///< ik error (m), iterations, reached, error of held feet (m)
    kSkin,
    kSkinVelocity,
    kSkinInverseMass
  };
};

class Skeleton final : public Tabled<Skeleton, StagedSystem>, public FollowsBones, public Rigged {
 public:
  Skeleton(const SkeletonDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void apply(State& state, const Command& command) const override;
  void check(StateCheck& check, double t) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  Ports ports() const override;
  RigPort rig() const override;
  void prepare(State& state) const override;
  void follow(State& state, std::span<const Pose> bones, std::span<const uint8_t> given, double h,
              Workspace& workspace) const override;
  void resume(State& state, double t, const PoseMatch& match, Workspace& workspace) const override;

  const Model& model() const { return model_; }

 private:
  struct Scratch;
  void plan_stages(const SkeletonDef& def);
  void take_motions(const SkeletonDef& def);
  void learn(const PriorDef& def);
  struct GoalReach;
  std::vector<GoalReach> reached(const State& state, double t) const;
  double prior_distance(const State& state) const;
  void joint_values(const State& state, ShownRows rows, double* out) const;
  /// Sets everything as it is at t, h after the time of the state.
  void update(State& state, double t, double h, Scratch& scratch) const;
  void drive(const State& state, double t, Scratch& scratch) const;
  /// Its own motion at `own_time`, as if nothing had moved it.
  void drive_at(const State& state, double own_time, Scratch& scratch) const;
  void reach(State& state, Scratch& scratch) const;
  void hold_feet(State& state, double t, Scratch& scratch) const;
  bool is_led(const State& state) const;
  double own_time(const State& state, double t) const;
  /// Blends from the pose in which bodies left it to its own motion.
  void blend_back(State& state, double t, Scratch& scratch) const;
  void write(State& state, double h, Scratch& scratch) const;
  /// Moves the skin with the bones.
  void cover(State& state, double h, Scratch& scratch) const;
  animation::IkGoal goal(const GoalDrive& g, std::span<const double> out) const;

  animation::Driver driver_;
  double dt_;
  std::optional<Recording> file_;
  Model model_;
  Clip clip_;
  struct Layer {
    Clip clip;
    size_t weight = 0;  ///< output
    LayerDef::Mode mode = LayerDef::Mode::cross_fade;
  };
  std::vector<Layer> layers_;
  std::optional<MarkerReport> markers_;
  animation::PosePrior prior_;
  double prior_spread_ = 0;
  animation::IkOptions options_;
  SkinDef::Method skinning_ = SkinDef::Method::dual_quaternion;
  SkeletonDef::Publish publish_;
  std::optional<Vec3> color_, skin_color_;
  std::vector<Solid> solids_;
  std::vector<BodyForm> forms_;
  std::vector<Pose> bone_poses_;  ///< in their joints' frames
  std::vector<uint32_t> joint_of_bone_;
};

std::unique_ptr<const System> build_skeleton(const void* def, const BuildContext& context);

}  // namespace truestep::skeleton
