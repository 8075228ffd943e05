// The system type "molecular": a MolecularField advanced by any integrator of the table, velocity Verlet by
// default. Before the step the list of neighbours is renewed where somebody may have moved half a skin.
#pragma once
#include "engine/core/force_system.h"
#include "engine/integrators/motion.h"
#include "engine/integrators/table/default_method.h"
#include "engine/systems/molecular/molecular_field.h"

namespace truestep::molecular {

class Molecular final : public ForceSystem {
 public:
  /// Error "scene_invalid" when the def's integrator is unknown or does not fit.
  static std::unique_ptr<const Molecular> make(const MolecularDef& def, const BuildContext& context);

  /// Besides the energies (J): temperature (K), pressure (Pa), virial (J), the tails of energy and pressure,
  /// momentum.x/y/z (kg m/s), displacement (m^2, mean square since t = 0).
  void observe(const State& state, double t, Observables& out) const override;
  /// position (m, in the box), velocity, speed; of part "distribution" the distance and g(r).
  FieldView field(const State& state, size_t part, size_t field, std::vector<double>& scratch) const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  /// Open where a bath gives or takes energy.
  Energy::Exchange exchange(const State&) const override;

  const MolecularField& atoms() const { return atoms_; }
  std::vector<std::string> remedies() const override {
    return {"a step of at most a twentieth of the fastest vibration's period",
            "a start whose atoms do not overlap"};
  }
  /// None where the step is an own one.
  Integration integration() const override;
  /// K
  double temperature(double kinetic) const;

 private:
  Molecular(std::unique_ptr<const MolecularField> field, const ChosenMethod& method,
            const IntegratorOptions& options);
  void plan_stages(const std::string& why_this_method);
  /// Velocities by a factor; the heat that this gave.
  void scale_velocities(State& state, double factor, const ThreadArena& arena) const;
  double kinetic(const State& state, const StepInput& in) const;
  void rescale(State& state, const StepInput& in) const;
  void half_chain(State& state, const StepInput& in) const;
  void change_box(State& state, const StepInput& in) const;
  /// Velocity Verlet (rigid.cc) that keeps rigid molecules, and of langevin with friction and noise between
  /// two halves of the drift.
  void advance_own(State& state, const StepInput& in) const;
  bool has_own_step() const;
  /// x += h v, rigid molecules by SETTLE.
  void drift(Motion& m, double h) const;
  /// Velocities without parts along rigid sides.
  void settle(Motion& m) const;
  /// The heat given.
  double add_noise(Motion& m) const;
  /// J: 2 K + r . f of rigid molecules about their centres, which their sides take up.
  double within_molecules(const Phase& at, Evaluation& e) const;
  void distribution(const State& state, std::vector<double>& out) const;

  const MolecularField& atoms_;
};

std::unique_ptr<const System> build_molecular(const void* def, const BuildContext& context);

}  // namespace truestep::molecular
