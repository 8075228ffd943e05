// The equations of motion of a tree of links as a force field: x are the joint coordinates, v their
// velocities, x' = G(x) v, as quaternions have four numbers for three velocities. Joints may have drives: tau
// = torque - damping v - stiffness (q - rest) - limits; balls have the potential 2 k sin^2(angle / 2), whose
// torque is -2 k w (x, y, z) of the unit quaternion; their limits are in ball_limits.h. Beyond a limit a
// spring and a damper push back; together they never pull.
#pragma once
#include "engine/core/commands/user_forces.h"
#include "engine/core/equations/force_field.h"
#include "engine/systems/articulation/model.h"

namespace truestep::articulation {

class LinearTree;

/// Columns of the state in their order.
struct Columns {
  enum Index : State::Column {
    kPosition,
    kVelocity,
    kTorque,        ///< N m or N, one per velocity
    kGravity,       ///< m/s^2, 3
    kPushLink,      ///< link that is pushed; one row per push
    kPushForce,     ///< N
    kPushAt,        ///< m, in the frame of the link's joint
    kPushRemaining  ///< s
  };
  static constexpr UserForces kHands{UserForces::PushColumns{kPushLink, kPushForce, kPushRemaining, kPushAt}};
};

class ArticulationField final : public ForceField {
 public:
  /// Error "scene_invalid" if a joint has nothing to move or a loop cannot be closed; the initial coordinates
  /// are corrected so that loops close.
  ArticulationField(Model model, const Vec3& gravity);

  State initial_state() const override;
  void acceleration(const Phase& at, std::span<double> a, Evaluation& e) const override;
  std::span<const double> position_rate(const Phase& at, std::span<double> rate,
                                        Evaluation& e) const override;
  void project(std::span<double> x, std::span<double> v, const State& state) const override;
  Dependence dependence() const override { return Dependence::position_and_velocity; }
  std::optional<double> potential(const Phase& at, Evaluation& e) const override;
  double kinetic(const Phase& at, Evaluation& e) const override;
  std::optional<Stiffness> stiffness(const State& state) const override;
  /// In O(n) for trees without closures and springs between links.
  std::unique_ptr<FieldLinearSolver> linear_solver() const override;
  /// The tree linearised about `at`, without closures and springs.
  void linearise(const Phase& at, LinearTree& out, Evaluation& e) const;

  const Model& model() const { return model_; }
  /// Frames and velocities of all nodes; the second also gives accelerations and joint forces.
  Work placed(const State& state) const;
  Work accelerated(const State& state) const;
  /// Change of v when an impulse (N s, world) hits `link` at its centre.
  std::vector<double> response(const State& state, size_t link, const Vec3& impulse, const Vec3& at) const;
  /// The point at which a link is held, in the frame of its joint: `place` (m, in the world), or its centre
  /// of mass.
  Vec3 hold(const State& state, size_t link, const std::optional<Vec3>& place) const;

 private:
  void efforts(const Phase& at, std::span<double> tau) const;
  void add_pushes(const State& state, std::vector<Push>& out) const;
  void solve(const Phase& at, std::span<NodeWork> work, std::span<double> tau, ClosureWork& scratch,
             std::span<double> a) const;
  Vec3 reach(const LinkSpring& s, std::span<const NodeWork> work, Of what) const;
  void pull_spring(const LinkSpring& s, std::span<const NodeWork> work, std::vector<Push>& pushes) const;
  void refuse_empty_joints();
  void close_start();

  Model model_;
  Vec3 gravity_;
  Stiffness stiffness_;
};

}  // namespace truestep::articulation
