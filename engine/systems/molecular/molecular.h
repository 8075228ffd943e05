// The system type "molecular": a MolecularField advanced by any integrator of the table, velocity Verlet by
// default. Before the step the neighbour list is renewed if an atom may have moved by half a skin.
#pragma once
#include "engine/core/equations/force_system.h"
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/motion.h"
#include "engine/integrators/table/default_method.h"
#include "engine/systems/molecular/molecular_field.h"

namespace truestep::molecular {

class Molecular final : public Tabled<Molecular, ForceSystem> {
 public:
  /// Error "scene_invalid" when the def's integrator is unknown or unsuitable.
  static std::unique_ptr<const Molecular> make(const MolecularDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  /// Open when a bath exchanges energy.
  Energy::Exchange exchange(const State&) const override;

  const MolecularField& atoms() const { return atoms_; }
  /// K
  double temperature(double kinetic) const;

 private:
  Molecular(std::unique_ptr<const MolecularField> field, const ChosenMethod& method,
            const IntegratorOptions& options);
  void plan_stages(const std::string& why_this_method);
  /// Scales velocities; returns the heat added.
  void scale_velocities(State& state, double factor, const ThreadArena& arena) const;
  double kinetic(const State& state, const StepInput& in) const;
  void rescale(State& state, const StepInput& in) const;
  void half_chain(State& state, const StepInput& in) const;
  void change_box(State& state, const StepInput& in) const;
  /// Velocity Verlet (rigid.cc) with rigid molecules, and for langevin with friction and noise between two
  /// half drifts.
  void advance_own(State& state, const StepInput& in) const;
  bool has_own_step() const;
  /// x += h v, rigid molecules by SETTLE.
  void drift(Motion& m, double h) const;
  /// Removes velocity components along rigid sides.
  void settle(Motion& m) const;
  /// Returns the heat added.
  double add_noise(Motion& m) const;
  /// J: 2 K + r . f of rigid molecules about their centres, which is balanced by their constraints.
  double within_molecules(const Phase& at, Evaluation& e) const;
  struct Whole;
  Whole whole(const State& state, double t) const;
  /// m, up to which the radial distribution is counted.
  double range(const State& state) const;
  void wrap(const State& state, ShownRows rows, double* out) const;
  void distances(const State& state, ShownRows bins, double* out) const;
  void distribution(const State& state, ShownRows bins, double* out) const;

  const MolecularField& atoms_;
};

std::unique_ptr<const System> build_molecular(const void* def, const BuildContext& context);

}  // namespace truestep::molecular
