#include "engine/systems/molecular/molecular_def.h"

#include "engine/systems/molecular/atoms.h"

namespace truestep::molecular {
namespace {

const DefTable& kind_table() {
  using D = KindDef;
  static const DefTable t =
      TableOf<D>("a kind of atom; two kinds mix by Lorentz and Berthelot")
          .text("name", &D::name, "as in positions and texts")
          .required()
          .number("mass", &D::mass, "kg", above(0), "of an atom; default argon")
          .number("sigma", &D::sigma, "m", at_least(0), "distance at which the Lennard-Jones potential is 0")
          .number("epsilon", &D::epsilon, "J", at_least(0), "depth of the Lennard-Jones potential")
          .number("charge", &D::charge, "C", any(), "of an atom")
          .build();
  return t;
}

const DefTable& lattice_table() {
  using D = LatticeDef;
  static const DefTable t =
      TableOf<D>("atoms on a crystal; its extent is the periodic box unless that is given")
          .choice("arrangement", &D::arrangement, {"fcc", "sc"},
                  "face-centred cubic (4 a cell) or simple cubic")
          .texts("kinds", &D::kinds, {0, 64}, "of the sites in turn; absent: the first kind")
          .integers("cells", &D::cells, between(1, 1000), {3, 3}, "along x, y, z")
          .number("number_density", &D::number_density, "1/m^3", above(0),
                  "atoms per volume, or lattice_constant")
          .number("lattice_constant", &D::lattice_constant, "m", above(0),
                  "edge of a cell, or number_density")
          .vector("center", &D::center, "m", any(), "of the crystal")
          .build();
  return t;
}

const DefTable& thermostat_table() {
  using D = ThermostatDef;
  static const DefTable t =
      TableOf<D>("what holds the temperature")
          .choice("method", &D::method, {"velocity_rescaling", "langevin", "nose_hoover"},
                  "all velocities by one random factor; friction and noise on every atom; or a chain of "
                  "Nose and Hoover, without random numbers")
          .number("temperature", &D::temperature, "K", above(0), "that is held")
          .number("time", &D::time, "s", above(0),
                  "relaxation time; of langevin 1 / friction, of nose_hoover that of the chain's masses")
          .integer("chain", &D::chain, between(1, 10), "links of nose_hoover")
          .build();
  return t;
}

const DefTable& barostat_table() {
  using D = BarostatDef;
  static const DefTable t =
      TableOf<D>("what holds the pressure of a periodic box: its size, by stochastic cell rescaling")
          .number("pressure", &D::pressure, "Pa", any(), "that is held")
          .number("time", &D::time, "s", above(0), "relaxation time")
          .number("compressibility", &D::compressibility, "1/Pa", above(0),
                  "of the substance, roughly: only the relaxation time depends on it")
          .integer("every", &D::every, between(1, 1000), "steps between two changes of the box")
          .build();
  return t;
}

void check_baths(const MolecularDef& d, const DefTable::Report& report) {
  if (d.barostat && d.sides == Sides::open) report("/barostat", "only a periodic box has a pressure");
  if (d.barostat && !d.thermostat) report("/barostat", "needs a thermostat, whose temperature its noise has");
  const bool langevin = d.thermostat && d.thermostat->method == ThermostatDef::Method::langevin;
  if (langevin && !d.integrator.empty() && d.integrator != "velocity_verlet") {
    report("/integrator", "langevin has a step of its own, which becomes velocity_verlet without friction");
  }
}

void check(const MolecularDef& d, const DefTable::Report& report) {
  check_baths(d, report);
  if (d.switch_from && !(*d.switch_from < d.cutoff)) report("/switch_from", "is below the cut-off");
  if (d.switch_from && d.truncation != Truncation::switched) {
    report("/switch_from", "only a switched potential has one");
  }
  check_atoms(d, report);
}

}  // namespace

const DefTable& molecular_table() {
  using D = MolecularDef;
  static const DefTable t = [] {
    TableOf<D> table("atoms that attract and repel each other: gases, liquids, crystals, droplets");
    table.objects("kinds", &D::kinds, kind_table(), {1, 64}, "kinds of atoms")
        .required()
        .object("lattice", &D::lattice, lattice_table(), "atoms on a crystal")
        .vectors("positions", &D::positions, "m", any(), {0, 4'000'000}, "of atoms; their rows come first")
        .texts("position_kinds", &D::position_kinds, {0, 4'000'000},
               "one per position, or one for all; absent: the first kind")
        .vectors("velocities", &D::velocities, "m/s", any(), {0, 4'000'000}, "one per position, or none")
        .text("xyz", &D::xyz, "atoms in the text format XYZ: their number, a comment, then name x y z a line")
        .number("xyz_unit", &D::xyz_unit, "m", above(0), "length that is 1 in the text; default an angstrom")
        .choice("sides", &D::sides, {"open", "periodic"}, "no box, or one whose opposite sides are one")
        .vector("box", &D::box, "m", above(0), "edges; absent: the lattice's extent")
        .vector("center", &D::center, "m", any(), "of the box, where that is given")
        .number("cutoff", &D::cutoff, "m", above(0), "no force between pairs beyond")
        .number("skin", &D::skin, "m", above(0), "neighbours are listed up to cutoff + skin")
        .choice("truncation", &D::truncation, {"truncated", "shifted", "switched"},
                "how Lennard-Jones ends: as it is, shifted to 0, or switched to 0 with its force from "
                "switch_from on")
        .number("switch_from", &D::switch_from, "m", at_least(0), "absent: 0.9 of the cut-off")
        .number("temperature", &D::temperature, "K", at_least(0),
                "of the start: random velocities without momentum; absent: at rest")
        .number("boltzmann", &D::boltzmann, "J/K", above(0), "Boltzmann's constant; 1 in reduced units")
        .object("thermostat", &D::thermostat, thermostat_table(), "absent: the energy stays")
        .object("barostat", &D::barostat, barostat_table(), "absent: the box stays")
        .integer("distribution_bins", &D::distribution_bins, between(1, 100'000), "rows of part distribution")
        .number("distribution_range", &D::distribution_range, "m", above(0),
                "of part distribution, at most half an edge; absent: the cut-off")
        .number("draw_radius", &D::draw_radius, "m", at_least(0), "size in pictures")
        .vector("color", &D::color, "1", between(0, 1), "linear red, green, blue");
    return add_integrator_rows(table).check(check).build();
  }();
  return t;
}

const Outputs& molecular_outputs() {
  static const Outputs kOutputs{
      .rows = "an atom: positions first, then xyz, then lattice",
      .fields = {{"position", "m", 3, "within the box"},
                 {"velocity", "m/s", 3, ""},
                 {"speed", "m/s", 1, "magnitude of the velocity"},
                 {"distribution.distance", "m", 1,
                  "of part distribution, in a periodic box: middle of a shell"},
                 {"distribution.density", "1", 1, "g(r): density about an atom over the mean one"}},
      .observables = {{"energy.kinetic", "J", ""},
                      {"energy.potential", "J", "within the cut-off"},
                      {"energy.total", "J", ""},
                      {"energy.conserved", "J",
                       "energy.total without what the thermostat gave; of nose_hoover with its chain's"},
                      {"energy.tail", "J", "of what is beyond the cut-off, were it spread evenly"},
                      {"temperature", "K", ""},
                      {"virial", "J", "sum over pairs of r . f"},
                      {"pressure", "Pa", "(2 energy.kinetic + virial) / 3 V, of a periodic box"},
                      {"pressure.tail", "Pa", "as energy.tail"},
                      {"volume", "m^3", "of a periodic box"},
                      {"momentum.x", "kg m/s", ""},
                      {"momentum.y", "kg m/s", ""},
                      {"momentum.z", "kg m/s", ""},
                      {"displacement", "m^2", "mean square since the start"}}};
  return kOutputs;
}

Cost molecular_cost(const void* def) {
  const auto& d = *static_cast<const MolecularDef*>(def);
  const double n = static_cast<double>(atom_count(d));
  // Neighbours at a liquid's density, one atom in 1.1 sigma^3.
  double sigma = 0.3 * d.cutoff;
  for (const KindDef& k : d.kinds) sigma = k.sigma > 0 && k.sigma < sigma ? k.sigma : sigma;
  const double reach = (d.cutoff + d.skin) / sigma, near = std::min(n, 3.8 * reach * reach * reach);
  return {.state_bytes = 96 * n,
          .workspace_bytes = (300 + 6 * near) * n,
          .elements = n,
          .seconds_per_step = (3e-8 + 3e-9 * near) * n};
}

}  // namespace truestep::molecular
