#include "engine/systems/particles/pair_forces.h"

#include <algorithm>

#include "engine/neighbours/point_grid.h"

namespace truestep::particles {
namespace {

/// Rows per block: neighbour loops are long, so blocks are short.
constexpr size_t kPairBlock = 256;

double largest_cutoff(std::span<const PairLaw> laws) {
  double reach = 0;
  for (const PairLaw& law : laws) reach = std::max(reach, law.cutoff);
  return reach;
}

PointGrid& grid_of(const Phase& at, double reach, Evaluation& e) {
  PointGrid& grid = e.workspace.object<PointGrid>("particles.grid");
  grid.build(at.x, reach, e.arena);
  return grid;
}

/// visit(point j, d = x_j - x_i, |d|^2) for the neighbours of the point in a slot, excluding itself.
template <class Visit>
void for_neighbours(const PointGrid& grid, size_t slot, double reach2, Visit&& visit) {
  const Vec3 x = grid.position(slot);
  grid.near(x, [&](size_t begin, size_t end) {
    for (size_t q = begin; q < end; ++q) {
      const Vec3 d = grid.position(q) - x;
      const double r2 = norm2(d);
      if (r2 < reach2 && q != slot) visit(grid.point(q), d, r2);
    }
  });
}

PairLaw law_of(const PowerLawDef& d) {
  return {PairLaw::Kind::power_law, d.strength, d.cutoff, d.softening, static_cast<int>(d.exponent)};
}
PairLaw law_of(const SoftRepulsionDef& d) {
  return {PairLaw::Kind::soft_repulsion, d.stiffness, d.cutoff, 0, 0};
}
PairLaw law_of(const ViscosityDef& d) {
  return {PairLaw::Kind::viscosity, d.coefficient, d.cutoff, 0, 0};
}

}  // namespace

std::vector<PairLaw> pair_laws(const std::vector<PairForceDef>& defs) {
  std::vector<PairLaw> laws;
  for (const PairForceDef& d : defs) laws.push_back(std::visit([](const auto& p) { return law_of(p); }, d));
  return laws;
}

void add_pair_forces(std::span<const PairLaw> laws, const Phase& at, const double* mass, std::span<double> a,
                     Evaluation& e) {
  const double reach = largest_cutoff(laws);
  const PointGrid& grid = grid_of(at, reach, e);
  const double* v = at.v.data();
  e.arena.for_blocks(grid.size(), kPairBlock, [&](size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; ++slot) {
      const size_t i = grid.point(slot);
      const Vec3 vi = load3(v, i);
      Vec3 force;
      for_neighbours(grid, slot, reach * reach, [&](size_t j, const Vec3& d, double r2) {
        const Vec3 w = load3(v, j) - vi;
        for (const PairLaw& law : laws) {
          if (r2 < law.cutoff * law.cutoff) force += pair_force(law, d, w, r2);
        }
      });
      store3(a.data(), i, load3<double>(a.data(), i) + force / mass[i]);
    }
  });
}

double pair_potential_energy(std::span<const PairLaw> laws, const Phase& at, Evaluation& e) {
  const double reach = largest_cutoff(laws);
  const PointGrid& grid = grid_of(at, reach, e);
  return e.arena.sum_blocks(grid.size(), kPairBlock, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t slot = begin; slot < end; ++slot) {
      for_neighbours(grid, slot, reach * reach, [&](size_t, const Vec3&, double r2) {
        for (const PairLaw& law : laws) {
          if (r2 < law.cutoff * law.cutoff) sum += 0.5 * pair_potential(law, r2);
        }
      });
    }
    return sum;
  });
}

}  // namespace truestep::particles
