#include "engine/systems/particles/coulomb.h"

#include "engine/kernels/gravity/direct_sums.h"

namespace truestep::particles {

namespace {

/// The sums' bodies: strength factor q each.
gravity::Bodies bodies(const Charges& charges, double factor, const Phase& at, Workspace& workspace) {
  const size_t n = at.x.size() / 3;
  const auto strength = workspace.doubles("particles.coulomb.strength", n).first(n);
  for (size_t i = 0; i < n; ++i) strength[i] = factor * charges[i];
  return {at.x, strength};
}

gravity::Softening softening(const CoulombDef& d) {
  return {gravity::SofteningKind::plummer, d.softening};
}

}  // namespace

void add_coulomb(const CoulombDef& d, const Charges& charges, const Phase& at, const double* mass,
                 std::span<double> a, Evaluation& e) {
  const size_t n = at.x.size() / 3;
  if (n < 2) return;
  const auto field = e.workspace.doubles("particles.coulomb.field", 3 * n).first(3 * n);
  // The sums attract: minus for the repulsion of like charges.
  direct_accelerations(bodies(charges, -d.constant, at, e.workspace), softening(d), field,
                       e.workspace.object<gravity::DirectScratch>("particles.coulomb"), e.arena);
  for (size_t i = 0; i < n; ++i) {
    const double s = charges[i] / mass[i];
    for (size_t k = 0; k < 3; ++k) a[3 * i + k] += s * field[3 * i + k];
  }
}

double coulomb_energy(const CoulombDef& d, const Charges& charges, const Phase& at, Evaluation& e) {
  if (at.x.size() < 6) return 0;
  auto& scratch = e.workspace.object<gravity::DirectScratch>("particles.coulomb");
  return d.constant * direct_potential(bodies(charges, 1, at, e.workspace), softening(d), scratch, e.arena);
}

}  // namespace truestep::particles
