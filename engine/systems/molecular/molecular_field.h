// Forces between atoms: m a = sum over pairs within the cut-off (kernels/molecular/pair_law.h) + bonds,
// angles and dihedrals (bonded.h) + Ewald's waves (ewald.h). Neighbour lists belong to the column of
// reference positions, so they are functions of the state; an integrator stage that is farther away than half
// a skin gets a list of its own.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "engine/core/equations/force_field.h"
#include "engine/kernels/molecular/mesh_ewald.h"
#include "engine/kernels/molecular/pair_law.h"
#include "engine/systems/molecular/atoms.h"
#include "engine/systems/molecular/neighbour_list.h"
#include "engine/systems/molecular/topology.h"

namespace truestep::molecular {

/// Columns of the state, in the order in which initial_state adds them.
struct Columns {
  enum : State::Column {
    position,  ///< m, unwrapped
    velocity,
    reference,  ///< m, positions for which the neighbour list was made
    start,      ///< m, positions at t = 0, for the mean square displacement
    box,        ///< m, edges; 0 when there is no box
    bath,       ///< see Bath
    chain,      ///< positions (1) and velocities (1/s) of a Nose-Hoover chain
  };
};

/// Rows of the column `bath`: target temperature (K) and pressure (Pa), heat (J) added by the thermostat.
enum class Bath : uint8_t { temperature, pressure, heat, count };

/// Energy and virial of the forces, J.
struct Energies {
  double pairs = 0, bonds = 0, waves = 0, virial = 0;
  double potential() const { return pairs + bonds + waves; }
};

class MolecularField final : public ForceField {
 public:
  MolecularField(const MolecularDef& def, const BuildContext& context);

  State initial_state() const override;
  void acceleration(const Phase& at, std::span<double> a, Evaluation& e) const override;
  Dependence dependence() const override { return Dependence::position; }
  std::optional<double> potential(const Phase& at, Evaluation& e) const override;
  double kinetic(const Phase& at, Evaluation& e) const override;
  std::span<const double> inverse_mass(const State&) const override { return inverse_masses_; }
  /// omega^2 = 8 k / m of the stiffest pair's curvature k = 57.15 epsilon / sigma^2 at its minimum: the
  /// fastest wave of a close-packed crystal.
  std::optional<Stiffness> stiffness(const State& state) const override;

  Energies energies(const Phase& at, Evaluation& e) const;
  /// If half a skin may be used up within the next h, the present positions become the reference.
  void renew_reference(State& state, double h, const ThreadArena& arena, Workspace& workspace) const;

  const MolecularDef& def() const { return def_; }
  const PairLaw& law() const { return law_; }
  const std::vector<double>& masses() const { return masses_; }
  const Atoms& start() const { return start_; }
  const std::vector<uint32_t>& kinds() const { return setting_.kinds; }
  size_t size() const { return masses_.size(); }
  uint64_t seed() const { return seed_; }
  /// Degrees of freedom: without those of the centre of mass when its momentum is conserved.
  double freedoms() const { return freedoms_; }
  Cell cell(const State& state) const;

 private:
  const NeighbourList& list(const Phase& at, Evaluation& e) const;
  void make_law();
  void make_coulomb();
  /// Adds forces (N) of bonds, angles and dihedrals unless `force` is empty; returns their energy and virial.
  Energies add_bonds(const Phase& at, const Cell& cell, std::span<double> force) const;
  /// Ewald's smooth part, without that of the excluded pairs.
  Energies add_waves(const Phase& at, const Cell& cell, std::span<double> force, Evaluation& e) const;
  bool has_more() const;

  MolecularDef def_;
  Atoms start_;
  uint64_t seed_;
  double freedoms_ = 0;
  ListSetting setting_;
  std::vector<double> masses_, inverse_masses_;
  PairLaw law_;
  EwaldSetting ewald_;
  std::optional<MeshSetting> mesh_;
  std::vector<std::array<uint32_t, 2>> excluded_;
  PairSumFunction forces_, energies_;
};

}  // namespace truestep::molecular
