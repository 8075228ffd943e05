// How far a velocity field of particles is from divergence-free, as read from a state: the trace of
//   grad u_i = (sum_j V (u_j - u_i) grad W_ij) (sum_j V (x_j - x_i) grad W_ij)^-1,
// exact for fields that are linear, also beside walls and at the surface, where neighbours are missing
// (Bonet, Lok 1999, "Variational and momentum preservation aspects of SPH", section 4). Walls and bodies are
// left out, and so are particles with too few neighbours to tell.
#pragma once
#include "engine/systems/sph/fluid.h"

namespace truestep::sph {

/// 1/s, the largest magnitude; f is sorted and listed without walls, `velocity` is the state's column.
template <int D, class T>
double largest_divergence(Fluid<D, T>& f, const T* velocity, const ThreadArena& arena);

}  // namespace truestep::sph
