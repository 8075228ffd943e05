// Electrostatics between all particles, summed over every pair in f64 (kernels/gravity/direct_sums.h, whose
// strengths may have either sign):
//   F_i = k q_i sum_j q_j (x_i - x_j) / (r_ij^2 + eps^2)^(3/2),   V = k sum_{i<j} q_i q_j / (r^2 +
//   eps^2)^(1/2)
// Both ends of a pair feel the same force, so momentum is kept to rounding. Not here: a tree, whose moments
// about a centre of mass have no meaning for charges that sum to zero.
#pragma once
#include <span>

#include "engine/core/force_field.h"
#include "engine/systems/particles/particles_def.h"

namespace truestep::particles {

/// The charges of rows: each its own, or all the same.
struct Charges {
  std::span<const double> each;  ///< C, n or empty
  double common = 0;             ///< C
  double operator[](size_t i) const { return each.empty() ? common : each[i]; }
};

/// Adds the accelerations to a (n x 3, m/s^2); mass in kg.
void add_coulomb(const CoulombDef& def, const Charges& charges, const Phase& at, const double* mass,
                 std::span<double> a, Evaluation& e);
/// J.
double coulomb_energy(const CoulombDef& def, const Charges& charges, const Phase& at, Evaluation& e);

}  // namespace truestep::particles
