// The system type "rigid2d": rigid bodies in the plane x, y with contacts, dry friction and joints,
//   M dv/dt = f + J^T lambda,   gap >= 0, lambda_n >= 0, |lambda_t| <= mu lambda_n,
// solved for impulses in substeps with soft constraints (solver.h). The rows of its fields are the bodies
// (centres of mass). Commands: push, impulse, drag (all three at any point of the body), release, pin, unpin,
// remove, set_parameter (gravity, velocities of bodies, motors of joints).
#pragma once
#include <mutex>

#include "engine/core/def/build.h"
#include "engine/core/outputs/tabled.h"
#include "engine/systems/rigid2d/flat_bodies.h"
#include "engine/systems/rigid2d/model.h"
#include "engine/systems/rigid2d/solver/solver.h"

namespace truestep::rigid2d {

class Rigid2d final : public Tabled<Rigid2d, StagedSystem> {
 public:
  Rigid2d(const Rigid2dDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  /// The bodies; their solids are built at the first use.
  Ports ports() const override;
  /// Closed unless motors, user forces, constant loads, moving surfaces or kinematic bodies do work. Includes
  /// the springs of joints.
  std::optional<Energy> energy(const State& state, double t, Workspace& workspace,
                               const ThreadArena& arena) const override;
  std::optional<double> limit(Limit which, const State&, double) const override {
    return which == Limit::speed ? std::optional(speed_limit_) : std::nullopt;
  }
  void check(StateCheck& check, double t) const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;

  const Model& model() const { return model_; }

 private:
  struct Scratch;
  void add_stages();
  /// Of the constant part of the drawing.
  uint32_t drawing_version(const State& state) const;
  std::vector<ContactMark> contact_marks(const State& state) const;
  void draw_strings(const State& state, std::vector<DrawnString>& out) const;
  std::vector<JointMark> joint_marks(const State& state) const;
  void take_hands(State& s, const StepInput& in) const;
  template <class T>
  void solve(State& s, const StepInput& in) const;
  void end_step(State& s, const StepInput& in) const;
  SolverSettings settings_for(double dt, int steps) const;
  /// Number of substeps for which the impulses of this state were computed.
  int substeps(const State& s) const;
  void choose_substeps(State& s, const StepInput& in) const;
  /// m/s, as given or derived from gravity (m/s^2).
  double restitution_speed(double gravity, double dt) const;
  void wake(State& s, uint32_t body) const;
  void set_parameter(State& s, const Command& c) const;
  void set_motor(State& s, const Command& c) const;
  size_t sensor_overlaps(const State& s) const;
  struct Whole;
  Whole whole(const State& s, double t) const;
  struct AllJoints;
  AllJoints all_joints(const State& s, double t) const;
  struct OneJoint;
  OneJoint one_joint(const State& s, double t, size_t name) const;
  /// Fields, N and N m; of forces 3 numbers each (z is 0).
  void contact_forces(const State& s, ShownRows bodies, double* out) const;
  void contact_loads(const State& s, ShownRows bodies, double* out) const;
  void joint_forces(const State& s, ShownRows bodies, double* out) const;
  void joint_torques(const State& s, ShownRows bodies, double* out) const;
  void forces_on_second(const State& s, ShownRows joints, double* out) const;
  void torques_on_second(const State& s, ShownRows joints, double* out) const;

  Rigid2dDef settings_;  // without bodies, generators and joints
  Model model_;
  mutable std::once_flag drawn_made_;  ///< meshes are built at the first use
  mutable PartDrawing drawn_;
  mutable std::once_flag reached_;
  mutable std::unique_ptr<const FlatBodies> reach_;
  Vec3 gravity_;
  double dt_;
  double speed_limit_;  ///< m/s and rad/s
};

std::unique_ptr<const System> build_rigid2d(const void* def, const BuildContext& context);
Cost rigid2d_cost(const void* def);

}  // namespace truestep::rigid2d
