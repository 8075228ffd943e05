// The system type "fem": elastic bodies of finite elements (fem_field.h) in space, plane strain and plane
// stress. Dynamic bodies are advanced by any method of the table, implicit Euler by default; quasi-static
// ones are in equilibrium at the end of every step, found by Newton's method with a line search on the
// energy, with smaller load increments where that fails. Obstacles keep nodes out; with a barrier
// (barrier_step.h) the surface never touches them or itself. Commands: push, impulse, drag, release, pin,
// unpin, set_parameter (youngs_modulus, damping, gravity).
#pragma once
#include "engine/collision/points/surface_contacts.h"
#include "engine/core/equations/force_system.h"
#include "engine/core/equations/impulse_answer.h"
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/table/default_method.h"
#include "engine/systems/fem/barrier/barrier_step.h"
#include "engine/systems/fem/fem_field.h"

namespace truestep::fem {

class Fem final : public Tabled<Fem, ForceSystem>, public AnswersImpulses {
 public:
  /// Error "scene_invalid" if the def's integrator, an expression or a hold is invalid.
  static std::unique_ptr<const Fem> make(const FemDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void check(StateCheck& check, double t) const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  Ports ports() const override;
  void answer(State& state, const StepInput& input, Answer which, std::span<const double> impulses,
              std::span<double> dv) const override;
  Seconds answer_seconds() const override { return answer_seconds_; }
  std::optional<Energy> energy(const State& state, double t, Workspace& workspace,
                               const ThreadArena& arena) const override;
  void warn(const State& state, double h, std::vector<Warning>& out) const override;
  std::optional<double> limit(Limit which, const State& state, double h) const override;

  const Body& body() const { return elements_.body(); }
  const FemField& elements() const { return elements_; }
  const ColliderSet& colliders() const { return colliders_; }
  /// Null if there is none.
  const BarrierStep* barrier() const { return barrier_.get(); }
  /// Hz, ascending.
  const std::vector<double>& frequencies() const { return frequencies_; }

 private:
  Fem(std::unique_ptr<const FemField> field, const ChosenMethod& method, const FemDef& def, double dt);
  Energy::Exchange exchange(const State& state) const override;
  void add_barrier(const FemDef& def);
  void plan_stages(const FemDef& def, const std::string& why);
  /// For the plan: which elements, and why.
  std::string elements_of(const FemDef& def) const;
  struct Whole;
  Whole whole(const State& state, double t) const;
  /// Of nodes, and of their elements, mean by volume.
  void displacement(const State& state, ShownRows rows, double* out) const;
  void nodal_von_mises(const State& state, ShownRows rows, double* out) const;
  template <class Visit>
  void prescribed(double t, Visit visit) const;
  void begin_holds(State& s, double t, double h) const;
  void end_holds(State& s, double t, double h) const;
  struct Way;
  double find_imbalance(const State& s, const StepInput& in, Way& way) const;
  /// Whether a component of a position is not solved for.
  bool holds(const State& s, size_t k) const;
  void equilibrium(State& s, const StepInput& in) const;
  void solve_in_parts(State& s, const StepInput& in, Way& way) const;
  void resolve_contacts(State& s, const StepInput& in) const;
  /// Whether nodes are held to colliders within the solution of a step.
  bool solves_contacts() const;
  void add_dynamic_stages(const FemDef& def, const std::string& why, const std::string& elements);
  void add_contact_stages(const std::string& why);
  void step_on_surfaces(State& s, const StepInput& in) const;
  double default_drag(const State& s, size_t row) const;

  const FemField& elements_;
  Motion motion_;
  PartDrawing drawing_;
  ColliderSet colliders_;
  std::vector<Surface> surfaces_;  // one per collider
  double radius_;                  // m, distance kept from colliders
  bool idle_;                      // colliders do no work
  double step_seconds_;            // on one core, estimated
  Seconds answer_seconds_;
  std::vector<Warning> locking_;
  SurfaceContacts on_surfaces_{
      colliders_,
      surfaces_,
      radius_,
      {FemColumns::position, FemColumns::velocity, FemColumns::inverse_mass, FemColumns::gravity},
      body().axes};
  std::vector<double> frequencies_;
  std::unique_ptr<const BarrierStep> barrier_;  // null: no barrier
};

/// s on one core of a step by `method` (null: the default).
double step_seconds(const FemDef& def, const Integrator* method);
/// Of the implicit methods.
AnswersImpulses::Seconds answer_seconds(const FemDef& def);
std::unique_ptr<const System> build_fem(const void* def, const BuildContext& context);

/// Lowest natural frequencies (Hz) of the body at rest with its holds, ascending: K y = (2 pi f)^2 M y by
/// subspace iteration, with a shift for the rigid motions of free bodies (Bathe 1996, section 11.6).
std::vector<double> natural_frequencies(const FemField& field, int count);

}  // namespace truestep::fem
