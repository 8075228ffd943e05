// Short-range forces between particles: every particle gathers from its neighbours in a cell-sorted grid, in
// an order that is a function of the positions alone. Pairs are computed twice, from both ends, with exactly
// opposite results.
#pragma once
#include <span>
#include <vector>

#include "engine/core/equations/force_field.h"
#include "engine/kernels/springs/pair_force.h"
#include "engine/systems/particles/particles_def.h"

namespace truestep::particles {

std::vector<PairLaw> pair_laws(const std::vector<PairForceDef>& defs);

/// Adds the accelerations of all laws to a (n x 3).
void add_pair_forces(std::span<const PairLaw> laws, const Phase& at, const double* mass, std::span<double> a,
                     Evaluation& e);
/// Sum of the potentials over all pairs, J.
double pair_potential_energy(std::span<const PairLaw> laws, const Phase& at, Evaluation& e);

}  // namespace truestep::particles
