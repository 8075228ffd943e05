// The system type "ode": states, parameters and right-hand sides as a user writes them,
//   dy/dt = f(t, y, p)   or   d2x/dt2 = a(t, x, x', p),
// integrated by any method of the table for right-hand sides, with events along the way; and tracers, points
// carried by a velocity field v(x, y, z, t). The default integrator is dop853 (tsit5 for tolerances from 1e-9
// on and for many states), or radau5 if the system looks stiff: at the start, or one explicit Euler step of a
// scene step from it, the dominant eigenvalue of df/dy (power iteration, differences of f) is real, negative
// and such that an explicit method would need more than 50 internal steps per step. An event that reverses a
// motion comes to rest at its guard once it moves nothing by more than the tolerance (ode_contacts.h).
// Command: set_parameter of a parameter or a state ("mu", "m[3]", "x").
#pragma once
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/advance.h"
#include "engine/systems/ode/ode_columns.h"
#include "engine/systems/ode/ode_equations.h"

namespace truestep::ode {

class Ode final : public Tabled<Ode, StagedSystem> {
 public:
  Ode(const OdeDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  std::optional<double> limit(Limit which, const State& state, double h) const override;

  const OdeModel& model() const { return model_; }
  const Integrator* method() const { return method_; }

 private:
  struct Scratch;
  Scratch& scratch(State& state, Workspace& workspace) const;
  void plan_stages();
  void sort_states();
  /// Parts of states: those that are numbers, and arrays by their lengths.
  std::vector<PartInfo> state_parts() const;
  struct Invariant;
  Invariant invariant(const State& state, double t, size_t k) const;
  struct Happened;
  Happened happened(const State& state, double t, size_t event) const;
  void integrate(State& state, const StepInput& in) const;
  double advance(State& state, Scratch& work, Workspace& workspace, double t, double t_end) const;
  double next_timed_event(double t, double slack) const;
  /// The integrator starts afresh: its memory of earlier steps belongs to other equations.
  static void forget(State& state);
  /// i32, per side of the model: 1 while it slides; only where there are sides.
  OdeColumns::Index sliding_column() const {
    return static_cast<OdeColumns::Index>(OdeColumns::kResting + (model_.contacts.empty() ? 0 : 1));
  }
  void cross(State& state, Scratch& work, uint32_t guard, double t) const;
  void refresh_sides(State& state, Scratch& work, double t) const;
  void settle(State& state, Scratch& work, uint32_t guard, int32_t side, double t) const;
  void wake(State& state, Scratch& work, double t, std::span<const double> before) const;
  void fire(State& state, Scratch& work, size_t event, double t) const;
  void carry_tracers(State& state, const StepInput& in) const;
  void draw_path(State& state, double t, Workspace& workspace) const;
  bool lies_in_plane() const;

  OdeDef def_;
  OdeModel model_;
  const Integrator* method_ = nullptr;  ///< null: no states, only tracers
  Tolerance tolerance_;
  IntegratorOptions options_;
  std::string why_this_method_;
  uint64_t seed_;
  size_t trail_ = 0, rows_ = 0;
  std::vector<double> tags_;  ///< per tracer
  /// Per part of states, the states that are its fields.
  std::vector<std::vector<size_t>> groups_;
  /// What is observed of states: numbers, and elements of short arrays.
  struct Observed {
    std::string name;
    uint32_t place;
  };
  std::vector<Observed> numbers_, elements_;
};

std::unique_ptr<const System> make_ode(const void* def, const BuildContext& context);

}  // namespace truestep::ode
