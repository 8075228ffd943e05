// Rigid bodies with contacts. Body i has a pose (x, q) of its centre of mass and principal axes and moves by
//   m x'' = f + sum(contact impulses),   L' = torque,   q' = 1/2 (0, w) q,   w = R I^-1 R^T L
//   separation >= 0,  normal impulse >= 0,  |friction| <= mu normal,  v_n+ = -e v_n-  (above
//   restitution_speed)
// Bodies without contacts follow their free motion (exact parabola, rotation of fourth order); the others go
// through the substepped solver (solver.h). Bodies that rest together sleep together.
#pragma once
#include <memory>
#include <mutex>

#include "engine/core/def/build.h"
#include "engine/core/outputs/tabled.h"
#include "engine/core/ports/body_sleep.h"
#include "engine/systems/rigid3d/contacts.h"
#include "engine/systems/rigid3d/solver/buckling.h"
#include "engine/systems/rigid3d/solver/solver.h"

namespace truestep::rigid3d {

class Rigid3d final : public Tabled<Rigid3d, StagedSystem>, public BodyOwner, public BodySleep {
 public:
  Rigid3d(const Rigid3dDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  /// Defined unless motors, user forces or kinematic bodies do work.
  std::optional<Energy> energy(const State& s, double t, Workspace& workspace,
                               const ThreadArena& arena) const override;
  std::optional<double> limit(Limit which, const State&, double) const override {
    return which == Limit::speed ? std::optional(speed_limit_) : std::nullopt;
  }
  void check(StateCheck& check, double t) const override;
  void step(State& s, const StepInput& in) const override;
  void apply(State& s, const Command& c) const override;
  /// Bodies are visuals of the main part, planes are obstacles.
  void draw(const State& s, double t, Wish wishes, Drawing& out) const override;

  /// The bodies; sensors touch nothing.
  Ports ports() const override;
  void wake(State& s, size_t row) const override;
  const BodySleep* sleep() const override { return this; }
  double sleep_speed() const override { return sleep_speed_; }
  bool asleep(const State& s, size_t row) const override;
  double sleep_timer(const State& s, size_t row) const override;
  void set_sleep_timer(State& s, size_t row, double seconds) const override;
  void lead(State& s, size_t row, const Vec3& rate, const Vec3& spin_rate) const override;

  const std::vector<BodyKind>& kinds() const { return bodies_.kinds; }

 private:
  /// Of the constant part of the drawing.
  uint32_t drawing_version(const State& state) const;
  /// Scratch memory of a step; nothing in it survives the step.
  struct Scratch {
    ContactList contacts;
    BucklingWatch buckling;
    ContactSolver<float> solver32;
    ContactSolver<double> solver64;
    std::vector<Vec3> change, twist;
    std::vector<Pose> before;
    std::vector<uint32_t> parent;
    std::vector<double> rested;
    std::vector<uint8_t> adrift;  ///< 1: no fixed body supports the body's island
    std::vector<uint32_t> near;
    std::vector<std::pair<uint32_t, double>> stopped;
    int parts = 1;  ///< number of parts into which this step is divided
  };
  static Scratch& scratch(const StepInput& in);
  /// True if contacts of the last step are mostly between bodies that rotate far in a step of h.
  bool contacts_turn_fast(const State& s, double h) const;
  /// Which bodies rotate far in a step of h, from columns that are looked up once.
  struct Turns {
    Turns(const State& s, std::span<const BodyKind> kinds, double h);
    bool fast(uint32_t body) const;
    std::span<const BodyKind> kinds;
    std::span<const uint32_t> kind, asleep;
    const double* spin;
    double h;
  };
  void forget_led_rates(State& s) const;
  void apply_forces(State& s, const StepInput& in) const;
  int substeps(const State& s, double h) const;
  void choose_substeps(State& s, const StepInput& in) const;
  /// Switches to `next` substeps in a step of h and rescales the per-substep values in the state.
  void change_substeps(State& s, double h, int now, int next) const;
  /// Number of substeps with which touching bodies rotate little in each.
  int substeps_of_turns(const State& s, double h) const;
  void find_contacts(State& s, const StepInput& in) const;
  void solve(State& s, const StepInput& in) const;
  /// m/s, as given or derived from gravity.
  double restitution_speed(const Vec3& gravity, double dt) const;
  void integrate_free(State& s, const StepInput& in) const;
  void stop_fast_bodies(State& s, const StepInput& in) const;
  void update_sleeping(State& s, const StepInput& in) const;
  bool all_asleep(const State& s) const;
  void set_parameter(State& s, const Command& c) const;
  size_t checked_body(const State& s, const Command& c) const;
  /// `parameter`: the command's name without the degree of freedom before it.
  void set_motor(State& s, const Command& c, std::string_view parameter) const;
  struct Whole;
  Whole whole(const State& s, double t) const;
  double applied_power(const State& s) const;
  struct AllJoints;
  AllJoints all_joints(const State& s, double t) const;
  struct OneJoint;
  OneJoint one_joint(const State& s, double t, size_t named) const;
  JointPlace place_of(const State& s, size_t joint) const;
  /// m and rad along and about x, y, z; of driven ones as they are counted over full turns.
  std::array<double, 6> coordinates(const State& s, size_t joint) const;
  void name_joints();
  /// Energy in J of the springs of unbroken joints, sum of k s^2 / 2.
  double spring_energy(const State& s) const;
  /// Largest distance (m) of two points that an unbroken joint keeps together.
  double widest_gap(const State& s) const;
  /// True where a joint can do work: motors, and a gap of more than a hundredth of a body that it closes.
  bool joints_drive(const State& s) const;
  /// Fields of bodies, N and N m: of contacts, their normal forces summed, and of joints.
  void contact_forces(const State& s, ShownRows rows, double* out) const;
  void contact_loads(const State& s, ShownRows rows, double* out) const;
  enum class JointLoad : uint8_t { force, torque };
  void joint_loads(const State& s, JointLoad what, ShownRows rows, double* out) const;

  const std::vector<Visual>& visuals() const;
  void draw_bodies(const State& s, PartDrawing& out) const;
  std::vector<DrawnShape> planes(const State& s) const;
  std::vector<ContactMark> contact_marks(const State& s) const;
  void draw_strings(const State& s, std::vector<DrawnString>& out) const;
  std::vector<JointMark> joint_marks(const State& s) const;

  BodyList bodies_;
  JointList joints_;
  std::vector<size_t> named_;  ///< joints with an id
  struct Axis {
    size_t joint, coordinate;
  };
  std::vector<Axis> slides_, turns_;     ///< theirs, of joints with several of the kind
  std::vector<BodyForm> forms_;          ///< one per kind
  mutable std::once_flag visuals_made_;  ///< meshes are built at the first use
  mutable std::vector<Visual> visuals_;
  SolverSettings settings_;  ///< restitution_speed is set in a step only
  std::optional<double> restitution_speed_;
  double speed_limit_ = 0;  ///< m/s and rad/s
  Rigid3dDef::Precision precision_;
  Vec3 gravity_;
  double sleep_speed_, sleep_time_;
  double dt_;  ///< s, of the scene's steps; for what is told of a state alone
  size_t most_bodies_;
};

}  // namespace truestep::rigid3d
