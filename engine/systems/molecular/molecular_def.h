// What a scene says about atoms and molecules; units and bounds stand in the tables (molecular_def.cc). Any
// consistent units work, since only `boltzmann` and `coulomb_constant` depend on them: in reduced units mass,
// sigma, epsilon and boltzmann are 1.
#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/equations/integrator_def.h"
#include "engine/core/outputs.h"
#include "engine/kernels/molecular/lennard_jones.h"
#include "engine/systems/molecular/cell.h"

namespace truestep::molecular {

struct KindDef {
  std::string name;
  double mass = 6.6335209e-26;                // kg: argon
  double sigma = 0, epsilon = 0, charge = 0;  // m, J, C
  std::optional<double> draw_radius;          // m
  std::optional<Vec3> color;
};

struct LatticeDef {
  enum class Arrangement : uint8_t { fcc, sc } arrangement = Arrangement::fcc;
  std::vector<std::string> kinds;  // of the sites in turn
  std::vector<int64_t> cells{4, 4, 4};
  std::optional<double> number_density, lattice_constant;  // 1/m^3, m
  Vec3 center;
};

/// Rigid water: one oxygen and two hydrogens per molecule, on a cubic lattice, randomly rotated.
struct WaterDef {
  std::vector<int64_t> cells{4, 4, 4};
  std::optional<double> radius;  // m, of a ball of them
  double spacing = 3.107e-10;    // m: 997 kg/m^3
  Vec3 center;
  std::string oxygen = "O", hydrogen = "H";
  double length = 1e-10, angle = 1.9106332362490186;  // m, rad: SPC/E
};

struct BondDef {
  int64_t a = 0, b = 0;
  double length = 1e-10, stiffness = 500;  // m, N/m
};
struct AngleDef {
  int64_t a = 0, b = 0, c = 0;
  double angle = 1.9, stiffness = 5e-19;  // rad, J
};
struct DihedralDef {
  int64_t a = 0, b = 0, c = 0, d = 0;
  double stiffness = 1e-20, phase = 0;  // J, rad
  int64_t multiplicity = 1;
};
enum class Coulomb : uint8_t { shifted, reaction_field, ewald, truncated };
/// How Ewald's smooth part is summed: wave by wave, or through a mesh.
enum class EwaldMethod : uint8_t { automatic, waves, mesh };

/// Temperature control.
struct ThermostatDef {
  enum class Method : uint8_t {
    velocity_rescaling,
    langevin,
    nose_hoover
  } method = Method::velocity_rescaling;
  double temperature = 300;  // K
  double time = 1e-13;       // s
  int64_t chain = 3;
};
/// Pressure control: stochastic cell rescaling.
struct BarostatDef {
  double pressure = 101325;          // Pa
  double time = 1e-12;               // s
  double compressibility = 4.5e-10;  // 1/Pa
  int64_t every = 10;                // steps
};

struct MolecularDef : IntegratorParams {
  std::vector<KindDef> kinds;
  std::optional<LatticeDef> lattice;
  std::vector<Vec3> positions, velocities;
  std::vector<std::string> position_kinds;
  std::string xyz;
  double xyz_unit = 1e-10;  // m

  std::optional<WaterDef> water;
  std::vector<BondDef> bonds;
  std::vector<AngleDef> angles;
  std::vector<DihedralDef> dihedrals;

  Sides sides = Sides::periodic;
  std::optional<Vec3> box;  // m, edges
  Vec3 center;

  double cutoff = 1e-9, skin = 1e-10;  // m
  std::optional<double> switch_from;   // m
  Truncation truncation = Truncation::truncated;
  Coulomb coulomb = Coulomb::shifted;
  double coulomb_constant = 8.9875517862e9;  // N m^2/C^2
  std::optional<double> dielectric;          // 1, absent: a conductor
  double ewald_accuracy = 1e-6;
  EwaldMethod ewald_method = EwaldMethod::automatic;
  std::optional<double> temperature;  // K
  double boltzmann = 1.380649e-23;    // J/K

  std::optional<ThermostatDef> thermostat;
  std::optional<BarostatDef> barostat;

  int64_t distribution_bins = 100;
  std::optional<double> distribution_range;  // m
  double draw_radius = 1e-10;
  std::optional<Vec3> color;

  /// Whether kinds have sizes or colours of their own for drawing.
  bool has_looks() const {
    const auto looks = [](const KindDef& k) { return k.draw_radius || k.color; };
    return std::any_of(kinds.begin(), kinds.end(), looks);
  }
};

const DefTable& molecular_table();
/// Whether Ewald's smooth part, if any, uses a mesh.
bool by_mesh(const MolecularDef& def);
const Outputs& molecular_outputs();
Cost molecular_cost(const void* def);

}  // namespace truestep::molecular
