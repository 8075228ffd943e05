// Forces within molecules, and Ewald's reciprocal sum. Serial: they are few compared with pairs.
#include <cmath>

#include "engine/kernels/molecular/bonded.h"
#include "engine/systems/molecular/molecular_field.h"

namespace truestep::molecular {
namespace {

void add3(std::span<double> force, size_t i, const Vec3& f) {
  if (!force.empty()) store3(force.data(), i, load3<double>(force.data(), i) + f);
}

/// E and G at u, also beyond the series, where erf is 1 to its accuracy.
ErfSeries::One smooth_part(const ErfSeries& series, double u) {
  if (u < series.u_max()) return series.at(u);
  const double i1 = 1 / std::sqrt(u);
  return {i1, i1 / u};
}

}  // namespace

Energies MolecularField::add_bonds(const Phase& at, const Cell& cell, std::span<double> force) const {
  Energies out;
  const auto between = [&](int64_t i, int64_t j) {
    return cell.nearest(load3(at.x.data(), static_cast<size_t>(i)) -
                        load3(at.x.data(), static_cast<size_t>(j)));
  };
  const auto add = [&](int64_t i, const Vec3& f) { add3(force, static_cast<size_t>(i), f); };
  for (const BondDef& b : def_.bonds) {
    const Vec3 d = between(b.a, b.b);
    const BondForce f = bond(d, b.stiffness, b.length);
    out.bonds += f.energy, out.virial += dot(d, f.on_a);
    add(b.a, f.on_a), add(b.b, -f.on_a);
  }
  // Angles do not change under uniform scaling: no virial.
  for (const AngleDef& b : def_.angles) {
    const AngleForce f = angle(between(b.a, b.b), between(b.c, b.b), b.stiffness, b.angle);
    out.bonds += f.energy;
    add(b.a, f.on_a), add(b.b, -(f.on_a + f.on_c)), add(b.c, f.on_c);
  }
  for (const DihedralDef& b : def_.dihedrals) {
    const DihedralForce f = dihedral(between(b.a, b.b), between(b.b, b.c), between(b.d, b.c), b.stiffness,
                                     static_cast<double>(b.multiplicity), b.phase);
    out.bonds += f.energy;
    add(b.a, f.on_a), add(b.b, f.on_b), add(b.c, f.on_c), add(b.d, f.on_d);
  }
  return out;
}

Energies MolecularField::add_waves(const Phase& at, const Cell& cell, std::span<double> force,
                                   Evaluation& e) const {
  Energies out;
  if (!(ewald_.alpha > 0)) return out;
  const auto& charges = setting_.charges;
  const EwaldEnergy waves = mesh_ ? e.workspace.object<MeshEwald>("molecular.mesh")
                                        .add(*mesh_, cell.edges, at.x, charges, force, e.arena)
                                  : e.workspace.object<EwaldSum>("molecular.ewald")
                                        .add(ewald_, cell.edges, at.x, charges, force, e.arena);
  out.waves = waves.energy, out.virial = waves.virial;
  const double a = ewald_.alpha;
  for (const auto& [i, j] : excluded_) {
    const Vec3 d = cell.nearest(load3(at.x.data(), i) - load3(at.x.data(), j));
    const double r2 = norm2(d), qq = ewald_.coulomb * setting_.charges[i] * setting_.charges[j];
    const auto f = smooth_part(law_.erf, a * a * r2);
    // Minus q q erf(alpha r) / r, whose force is repulsive.
    const Vec3 push = d * (-qq * a * a * a * f.g);
    out.waves -= qq * a * f.e, out.virial += dot(push, d);
    add3(force, i, push), add3(force, j, -push);
  }
  return out;
}

}  // namespace truestep::molecular
