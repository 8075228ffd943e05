// The system type "mass_spring": a MassSpringField advanced by any integrator, then contacts with obstacles
// and the end of pushes. Commands: push, impulse, drag, release, pin, unpin, set_parameter (stiffness,
// shear_stiffness, bending_stiffness, damping, internal_damping, gravity, wind).
#pragma once
#include "engine/collision/points/surface_contacts.h"
#include "engine/core/equations/force_system.h"
#include "engine/core/equations/impulse_answer.h"
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/control/rising_step.h"
#include "engine/integrators/table/default_method.h"
#include "engine/systems/mass_spring/mass_spring_field.h"

namespace truestep::mass_spring {

class MassSpring final : public Tabled<MassSpring, ForceSystem>, public AnswersImpulses {
 public:
  /// Error "scene_invalid" if the def's integrator is unknown or does not fit.
  static std::unique_ptr<const MassSpring> make(const MassSpringDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void check(StateCheck& check, double t) const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  /// The solids: the triangles of a cloth; otherwise a capsule along every structural spring and a ball at
  /// every point without one. Points that an implicit method solves together also respond to impulses
  /// together; loose points never do.
  Ports ports() const override;
  void answer(State& state, const StepInput& input, Answer which, std::span<const double> impulses,
              std::span<double> dv) const override;
  /// Open in wind, while something is pushed, and where obstacles may do work on points.
  Energy::Exchange exchange(const State& state) const override;
  std::optional<double> limit(Limit which, const State& state, double h) const override;
  Seconds answer_seconds() const override { return answer_seconds_; }

  const MassSpringField& springs() const { return springs_; }

 private:
  MassSpring(std::unique_ptr<const MassSpringField> field, const ChosenMethod& method,
             const MassSpringDef& def);
  void add_contact_stage();
  /// Whether contacts are part of the method's own solution.
  bool solves_contacts() const;
  /// Whether air or hands supply energy.
  static bool driven(const State& s);
  void advance(const Integrator& method, State& s, const StepInput& in) const;
  void integrate(State& s, const StepInput& in) const;
  void publish_segments();
  double default_drag(const State& state, size_t row) const;
  void set_parameter(State& state, const Command& command) const;
  struct Whole;
  Whole whole(const State& state, double t) const;
  /// N per point; of the field gusts are as at t = 0.
  void forces(const State& state, ShownRows rows, double* out) const;
  void reactions(const State& state, double t, std::span<double> out) const;
  void largest_strains(const State& state, ShownRows rows, double* out) const;
  void strains(const State& state, ShownRows rows, double* out) const;

  const MassSpringField& springs_;
  PartDrawing drawing_;
  ColliderSet colliders_;
  std::vector<Surface> surfaces_;  // one per collider
  double radius_;                  // m, distance kept from colliders
  double shortest_;                // m, of the springs' lengths
  double step_seconds_;            // estimated
  Seconds answer_seconds_;
  bool idle_;     // colliders do no work
  bool looks_;    // at the energy of steps
  bool divides_;  // steps that have no solution or gain energy
  RisingStep rising_;
  SurfaceContacts on_surfaces_{colliders_,
                               surfaces_,
                               radius_,
                               {MassSpringColumns::position, MassSpringColumns::velocity,
                                MassSpringColumns::inverse_mass, MassSpringColumns::gravity}};
  std::vector<std::array<uint32_t, 2>> segments_;  // published if there are no triangles
};

std::unique_ptr<const System> build_mass_spring(const void* def, const BuildContext& context);
Cost mass_spring_cost(const void* def);
/// s on one core of a step by `method` (null: the default).
double step_seconds(const MassSpringDef& def, const Integrator* method);
/// Of the default methods.
AnswersImpulses::Seconds answer_seconds(const MassSpringDef& def);

}  // namespace truestep::mass_spring
