#include "engine/systems/molecular/molecular_def.h"

#include <algorithm>

#include "engine/base/text/short_number.h"
#include "engine/kernels/molecular/mesh_ewald.h"
#include "engine/systems/molecular/atoms.h"

namespace truestep::molecular {
namespace {

const DefTable& kind_table() {
  using D = KindDef;
  static const DefTable t =
      TableOf<D>("a kind of atom; two kinds mix by the Lorentz-Berthelot rules")
          .text("name", &D::name, "name used by positions and texts")
          .required()
          .number("mass", &D::mass, "kg", above(0), "of an atom; default argon")
          .number("sigma", &D::sigma, "m", at_least(0), "distance at which the Lennard-Jones potential is 0")
          .number("epsilon", &D::epsilon, "J", at_least(0), "depth of the Lennard-Jones potential")
          .number("charge", &D::charge, "C", any(), "of an atom")
          .number("draw_radius", &D::draw_radius, "m", at_least(0), "size in pictures; absent: the system's")
          .vector("color", &D::color, "1", between(0, 1), "red, green, blue; absent: the system's")
          .build();
  return t;
}

const DefTable& lattice_table() {
  using D = LatticeDef;
  static const DefTable t =
      TableOf<D>("atoms on a crystal lattice; its extent is the periodic box unless edges are given")
          .choice("arrangement", &D::arrangement, {"fcc", "sc"},
                  "face-centred cubic (4 per cell) or simple cubic")
          .texts("kinds", &D::kinds, {0, 64}, "of successive sites; absent: the first kind")
          .integers("cells", &D::cells, between(1, 1000), {3, 3}, "along x, y, z")
          .number("number_density", &D::number_density, "1/m^3", above(0),
                  "atoms per volume, or lattice_constant")
          .number("lattice_constant", &D::lattice_constant, "m", above(0),
                  "edge of a cell, or number_density")
          .vector("center", &D::center, "m", any(), "of the crystal")
          .build();
  return t;
}

const DefTable& water_table() {
  using D = WaterDef;
  static const DefTable t =
      TableOf<D>("rigid molecules of water on a cubic lattice, randomly oriented; SPC/E by default")
          .integers("cells", &D::cells, between(1, 1000), {3, 3}, "molecules along x, y, z")
          .number("radius", &D::radius, "m", above(0), "only those within a ball of this radius")
          .number("spacing", &D::spacing, "m", above(0), "of the lattice")
          .vector("center", &D::center, "m", any(), "of the lattice and the ball")
          .text("oxygen", &D::oxygen, "its kind")
          .text("hydrogen", &D::hydrogen, "its kind")
          .number("length", &D::length, "m", above(0), "of the bond from oxygen to hydrogen")
          .number("angle", &D::angle, "rad", between(0.1, 3), "at the oxygen")
          .build();
  return t;
}

const DefTable& bond_table() {
  using D = BondDef;
  static const DefTable t = TableOf<D>("k/2 (r - L)^2 between two atoms")
                                .integer("a", &D::a, at_least(0), "an atom")
                                .integer("b", &D::b, at_least(0), "the other")
                                .number("length", &D::length, "m", at_least(0), "L")
                                .number("stiffness", &D::stiffness, "N/m", at_least(0), "k")
                                .build();
  return t;
}

const DefTable& angle_table() {
  using D = AngleDef;
  static const DefTable t = TableOf<D>("k/2 (theta - theta0)^2 at b between a and c")
                                .integer("a", &D::a, at_least(0), "an atom")
                                .integer("b", &D::b, at_least(0), "atom at the apex")
                                .integer("c", &D::c, at_least(0), "the other end")
                                .number("angle", &D::angle, "rad", between(0, 3.141592653589793), "theta0")
                                .number("stiffness", &D::stiffness, "J", at_least(0), "k, per rad^2")
                                .build();
  return t;
}

const DefTable& dihedral_table() {
  using D = DihedralDef;
  static const DefTable t =
      TableOf<D>(
          "k (1 + cos(n phi - delta)) of the planes a b c and b c d; phi = 0: a and d on the same side")
          .integer("a", &D::a, at_least(0), "an end")
          .integer("b", &D::b, at_least(0), "an atom of the axis")
          .integer("c", &D::c, at_least(0), "the other one")
          .integer("d", &D::d, at_least(0), "the other end")
          .number("stiffness", &D::stiffness, "J", any(), "k")
          .number("phase", &D::phase, "rad", any(), "delta")
          .integer("multiplicity", &D::multiplicity, between(1, 12), "n")
          .build();
  return t;
}

const DefTable& thermostat_table() {
  using D = ThermostatDef;
  static const DefTable t =
      TableOf<D>("controls the temperature")
          .choice("method", &D::method, {"velocity_rescaling", "langevin", "nose_hoover"},
                  "one random factor for all velocities; friction and noise on every atom; or a Nose-Hoover "
                  "chain, without random numbers")
          .number("temperature", &D::temperature, "K", above(0), "target value")
          .number("time", &D::time, "s", above(0),
                  "relaxation time; for langevin 1 / friction, for nose_hoover that of the chain's masses")
          .integer("chain", &D::chain, between(1, 10), "links of nose_hoover")
          .build();
  return t;
}

const DefTable& barostat_table() {
  using D = BarostatDef;
  static const DefTable t =
      TableOf<D>("controls the pressure of a periodic box by stochastic cell rescaling")
          .number("pressure", &D::pressure, "Pa", any(), "target value")
          .number("time", &D::time, "s", above(0), "relaxation time")
          .number("compressibility", &D::compressibility, "1/Pa", above(0),
                  "of the substance, roughly: it affects only the relaxation time")
          .integer("every", &D::every, between(1, 1000), "steps between two changes of the box")
          .build();
  return t;
}

void check_baths(const MolecularDef& d, const DefTable::Report& report) {
  if (d.barostat && d.sides == Sides::open) report("/barostat", "only a periodic box has a pressure");
  if (d.barostat && !d.thermostat)
    report("/barostat", "needs a thermostat, which sets the temperature of its noise");
  if (d.barostat && d.water) report("/barostat", "would stretch rigid molecules: not supported");
  const bool langevin = d.thermostat && d.thermostat->method == ThermostatDef::Method::langevin;
  if ((langevin || d.water) && !d.integrator.empty() && d.integrator != "velocity_verlet") {
    report("/integrator", "langevin and rigid molecules use their own velocity_verlet: leave it out");
  }
}

bool charged(const MolecularDef& d) {
  return std::any_of(d.kinds.begin(), d.kinds.end(), [](const KindDef& k) { return k.charge != 0; });
}

/// Wave vectors of Ewald's sum: half a ball of radius k_max in a lattice of 2 pi / edge.
double ewald_waves(const MolecularDef& d) {
  if (d.coulomb != Coulomb::ewald || !charged(d) || d.sides == Sides::open) return 0;
  const double k = ewald_setting(1, d.cutoff, d.ewald_accuracy).k_max / 6.283185307179586;
  const Vec3 edges = box_edges(d);
  return 2.1 * k * k * k * edges.x * edges.y * edges.z;
}

double mesh_points(const MolecularDef& d) {
  const MeshSetting mesh =
      mesh_setting(ewald_setting(1, d.cutoff, d.ewald_accuracy), box_edges(d), d.ewald_accuracy);
  return static_cast<double>(mesh.points[0] * mesh.points[1]) * static_cast<double>(mesh.points[2]);
}

/// s per step for Ewald's smooth part, measured on one core.
double waves_seconds(const MolecularDef& d) {
  return 5e-9 * ewald_waves(d) * static_cast<double>(atom_count(d));
}
double mesh_seconds(const MolecularDef& d) {
  return 1e-6 * static_cast<double>(atom_count(d)) + 3e-8 * mesh_points(d);
}

void check_charges(const MolecularDef& d, const DefTable::Report& report) {
  if (d.coulomb == Coulomb::ewald && d.sides == Sides::open) {
    report("/coulomb", "Ewald's sum needs periodic sides");
  }
  constexpr double kMostTerms = 2e9;
  if (!by_mesh(d) && ewald_waves(d) * static_cast<double>(atom_count(d)) > kMostTerms) {
    report("/ewald_method", "Ewald's sum would have " + short_number(ewald_waves(d)) +
                                " waves here, too many for this number of atoms");
  }
  if (d.dielectric && d.coulomb != Coulomb::reaction_field) {
    report("/dielectric", "only for a reaction field");
  }
}

void check(const MolecularDef& d, const DefTable::Report& report) {
  check_baths(d, report);
  check_charges(d, report);
  if (d.switch_from && !(*d.switch_from < d.cutoff)) report("/switch_from", "is below the cut-off");
  if (d.switch_from && d.truncation != Truncation::switched) {
    report("/switch_from", "only for a switched potential");
  }
  check_atoms(d, report);
}

}  // namespace

bool by_mesh(const MolecularDef& d) {
  if (d.ewald_method != EwaldMethod::automatic) return d.ewald_method == EwaldMethod::mesh;
  return mesh_seconds(d) < waves_seconds(d);
}

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
        .text("xyz", &D::xyz,
              "atoms in the text format XYZ: their number, a comment, then name x y z per line; or extended "
              "XYZ, "
              "whose Properties say which columns are these, and whose Lattice is the periodic box")
        .number("xyz_unit", &D::xyz_unit, "m", above(0), "unit of length in the text; default one angstrom")
        .object("water", &D::water, water_table(), "rigid molecules of water")
        .objects("bonds", &D::bonds, bond_table(), {0, 1'000'000},
                 "atoms joined by springs; they and second neighbours along bonds exert no other force")
        .objects("angles", &D::angles, angle_table(), {0, 1'000'000}, "springs of angles")
        .objects("dihedrals", &D::dihedrals, dihedral_table(), {0, 1'000'000}, "rotation about bonds")
        .choice("sides", &D::sides, {"open", "periodic"}, "no box, or a periodic box")
        .vector("box", &D::box, "m", above(0), "edges; absent: the lattice's extent, or the Lattice of xyz")
        .vector("center", &D::center, "m", any(), "of the box, if edges are given")
        .number("cutoff", &D::cutoff, "m", above(0), "distance beyond which pairs exert no force")
        .number("skin", &D::skin, "m", above(0), "neighbours are listed up to cutoff + skin")
        .choice("truncation", &D::truncation, {"truncated", "shifted", "switched"},
                "Lennard-Jones at the cut-off: truncated, shifted to 0, or switched to 0 with its force from "
                "switch_from on")
        .number("switch_from", &D::switch_from, "m", at_least(0), "absent: 0.9 of the cut-off")
        .choice("coulomb", &D::coulomb, {"shifted", "reaction_field", "ewald", "truncated"},
                "charges: with a force that falls to 0 at the cut-off, with a polarised surrounding beyond "
                "it, with all periodic images, or unchanged up to the cut-off (for smaller clusters)")
        .number("coulomb_constant", &D::coulomb_constant, "N m^2/C^2", above(0), "1 / (4 pi epsilon0)")
        .number("dielectric", &D::dielectric, "1", at_least(1),
                "of the surrounding of a reaction field; absent: a conductor")
        .number("ewald_accuracy", &D::ewald_accuracy, "1", between(1e-14, 1e-2),
                "truncation error of both Ewald sums")
        .choice("ewald_method", &D::ewald_method, {"auto", "waves", "mesh"},
                "of Ewald's smooth part: wave by wave; on a mesh, for many atoms; auto: the faster one")
        .number("temperature", &D::temperature, "K", at_least(0),
                "initial: random velocities without total momentum; absent: at rest")
        .number("boltzmann", &D::boltzmann, "J/K", above(0), "Boltzmann's constant; 1 in reduced units")
        .object("thermostat", &D::thermostat, thermostat_table(), "absent: the energy is conserved")
        .object("barostat", &D::barostat, barostat_table(), "absent: the box is fixed")
        .integer("distribution_bins", &D::distribution_bins, between(1, 100'000), "rows of part distribution")
        .number("distribution_range", &D::distribution_range, "m", above(0),
                "of part distribution, at most half an edge; absent: the cut-off")
        .number("draw_radius", &D::draw_radius, "m", at_least(0), "size in pictures")
        .vector("color", &D::color, "1", between(0, 1), "linear red, green, blue");
    return add_integrator_rows(table).check(check).build();
  }();
  return t;
}

Cost molecular_cost(const void* def) {
  const auto& d = *static_cast<const MolecularDef*>(def);
  const double n = static_cast<double>(atom_count(d));
  // Neighbours at liquid density, one atom in 1.1 sigma^3.
  double sigma = 0.3 * d.cutoff;
  for (const KindDef& k : d.kinds) sigma = k.sigma > 0 && k.sigma < sigma ? k.sigma : sigma;
  const double reach = (d.cutoff + d.skin) / sigma, near = std::min(0.6 * n, 3.8 * reach * reach * reach);
  const bool ewald = ewald_waves(d) > 0, mesh = ewald && by_mesh(d);
  return {.state_bytes = 96 * n,
          .workspace_bytes =
              (300 + 6 * near + (mesh ? 440 : 0.25 * ewald_waves(d))) * n + (mesh ? 18 * mesh_points(d) : 0),
          .elements = n,
          .seconds_per_step = (3e-8 + (charged(d) ? 8e-9 : 3e-9) * near) * n + (mesh    ? mesh_seconds(d)
                                                                                : ewald ? waves_seconds(d)
                                                                                        : 0)};
}

}  // namespace truestep::molecular
