// Electrostatics between all particles:
//   F_i = k q_i sum_j q_j (x_i - x_j) / (r_ij^2 + eps^2)^(3/2),
//   V = k sum_{i<j} q_i q_j / (r_ij^2 + eps^2)^(1/2)
// over every pair in f64 (kernels/gravity/direct_sums.h, whose strengths may have either sign), symmetrically
// for both ends, so that momentum is conserved to rounding; or by gravity's tree
// (kernels/gravity/tree_walk.h), once for the positive charges as sources and once for the negative ones,
// because moments about a centre of charge have no meaning where charges sum to zero. Its error is relative
// to the field of either sign alone; its net force is removed evenly from all particles.
#pragma once
#include <span>

#include "engine/core/equations/force_field.h"
#include "engine/systems/particles/particles_def.h"

namespace truestep::particles {

/// The charges of rows: individual or all the same.
struct Charges {
  std::span<const double> each;  ///< C, n or empty
  double common = 0;             ///< C
  double operator[](size_t i) const { return each.empty() ? common : each[i]; }
};

/// Whether n particles are summed by the tree.
bool by_tree(const CoulombDef& def, size_t n);

/// Adds the accelerations to a (n x 3, m/s^2); mass in kg.
void add_coulomb(const CoulombDef& def, const Charges& charges, const Phase& at, const double* mass,
                 std::span<double> a, Evaluation& e);
/// J; with the tree, to the accuracy of its sums.
double coulomb_energy(const CoulombDef& def, const Charges& charges, const Phase& at, Evaluation& e);

}  // namespace truestep::particles
