#include "engine/systems/particles/coulomb.h"

#include <cmath>
#include <functional>

#include "engine/kernels/gravity/tree_walk.h"

namespace truestep::particles {

namespace {

constexpr size_t kFewCharges = 5'000;  // all pairs take as long as two trees there
constexpr size_t kSumBlock = 1024;

gravity::Softening softening(const CoulombDef& d) {
  return {gravity::SofteningKind::plummer, d.softening};
}

/// The bodies of the sums: strength factor q each, for charges of one sign or (0) all of them.
gravity::Bodies bodies(const Charges& charges, double factor, int sign, const Phase& at,
                       Workspace& workspace) {
  const size_t n = at.x.size() / 3;
  const auto strength = workspace.doubles("particles.coulomb.strength", n).first(n);
  for (size_t i = 0; i < n; ++i) {
    const double q = charges[i];
    strength[i] = sign == 0 || q * sign > 0 ? factor * q : 0;
  }
  return {at.x, strength};
}

bool any_of(const Charges& charges, size_t n, int sign) {
  for (size_t i = 0; i < n; ++i) {
    if (charges[i] * sign > 0) return true;
  }
  return false;
}

/// Adds sum_j q_j (x_j - x_i)/r^3 to `field` (n x 3, C/m^2) and, unless it is empty, sum_j q_j/r to
/// `potential`.
void add_tree_sums(const CoulombDef& d, const Charges& charges, const Phase& at, std::span<double> field,
                   std::span<double> potential, Evaluation& e) {
  const size_t n = at.x.size() / 3;
  // As for gravity: the error goes as the opening's power 2/3.
  constexpr double kOpening = 100;
  const gravity::TreeSettings settings{softening(d), kOpening * d.force_error * std::sqrt(d.force_error)};
  const auto a = e.workspace.doubles("particles.coulomb.a", 3 * n).first(3 * n),
             p = e.workspace.doubles("particles.coulomb.p", n).first(potential.size());
  auto& tree = e.workspace.object<gravity::BodyTree>("particles.coulomb.tree");
  for (const int sign : {1, -1}) {
    if (!any_of(charges, n, sign)) continue;
    tree.build(bodies(charges, sign, sign, at, e.workspace), e.arena);
    tree_sums(tree, settings, {a, p}, e.arena);
    for (size_t i = 0; i < 3 * n; ++i) field[i] += sign * a[i];
    for (size_t i = 0; i < p.size(); ++i) potential[i] += sign * p[i];
  }
}

/// Sum of term(i) over n rows, the same for any number of threads.
template <class Term>
double sum_over(size_t n, const ThreadArena& arena, const Term& term) {
  const auto block = [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += term(i);
    return sum;
  };
  return arena.sum_blocks(n, kSumBlock, block);
}

/// Removes the net force of the forces q_i field_i evenly from all accelerations; `factor` converts them to
/// newtons.
void remove_net_force(const Charges& charges, std::span<const double> field, double factor,
                      const double* mass, std::span<double> a, const ThreadArena& arena) {
  const size_t n = a.size() / 3;
  const double total = sum_over(n, arena, [&](size_t i) { return mass[i]; });
  for (size_t k = 0; k < 3; ++k) {
    const double mean =
        factor / total * sum_over(n, arena, [&](size_t i) { return charges[i] * field[3 * i + k]; });
    for (size_t i = 0; i < n; ++i) a[3 * i + k] -= mean;
  }
}

}  // namespace

bool by_tree(const CoulombDef& d, size_t n) {
  return d.method == CoulombMethod::tree || (d.method == CoulombMethod::automatic && n > kFewCharges);
}

void add_coulomb(const CoulombDef& d, const Charges& charges, const Phase& at, const double* mass,
                 std::span<double> a, Evaluation& e) {
  const size_t n = at.x.size() / 3;
  if (n < 2) return;
  const bool tree = by_tree(d, n);
  const auto field = e.workspace.doubles("particles.coulomb.field", 3 * n).first(3 * n);
  // The sums are attractive: minus for the repulsion of like charges.
  if (tree) {
    std::fill(field.begin(), field.end(), 0.0);
    add_tree_sums(d, charges, at, field, {}, e);
  } else {
    direct_accelerations(bodies(charges, -d.constant, 0, at, e.workspace), softening(d), field,
                         e.workspace.object<gravity::DirectScratch>("particles.coulomb"), e.arena);
  }
  const double factor = tree ? -d.constant : 1;
  for (size_t i = 0; i < n; ++i) {
    const double s = factor * charges[i] / mass[i];
    for (size_t k = 0; k < 3; ++k) a[3 * i + k] += s * field[3 * i + k];
  }
  if (tree) remove_net_force(charges, field, factor, mass, a, e.arena);
}

double coulomb_energy(const CoulombDef& d, const Charges& charges, const Phase& at, Evaluation& e) {
  const size_t n = at.x.size() / 3;
  if (n < 2) return 0;
  if (!by_tree(d, n)) {
    auto& scratch = e.workspace.object<gravity::DirectScratch>("particles.coulomb");
    return d.constant *
           direct_potential(bodies(charges, 1, 0, at, e.workspace), softening(d), scratch, e.arena);
  }
  const auto field = e.workspace.doubles("particles.coulomb.field", 3 * n).first(3 * n),
             potential = e.workspace.doubles("particles.coulomb.potential", n).first(n);
  std::fill(field.begin(), field.end(), 0.0);
  std::fill(potential.begin(), potential.end(), 0.0);
  add_tree_sums(d, charges, at, field, potential, e);
  return 0.5 * d.constant * sum_over(n, e.arena, [&](size_t i) { return charges[i] * potential[i]; });
}

}  // namespace truestep::particles
