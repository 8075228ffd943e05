// Attraction of all bodies by all others, in f64:
//   a_i = G sum_j m_j w(r_ij) (x_j - x_i),   V = -G sum_{i<j} m_i m_j p(r_ij)      (softening.h)
// Each pair is computed once and counts for both (Newton's third law), four pairs side by side. Two bodies at
// the same position do not attract each other.
#pragma once
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/base/parallel.h"
#include "engine/kernels/gravity/softening.h"

namespace truestep::gravity {

/// n bodies: x in m (n x 3, row after row), G m in m^3/s^2.
struct Bodies {
  std::span<const double> x, mu;
  size_t size() const { return mu.size(); }
};

using AlignedDoubles = std::vector<double, CacheLineAllocator<double>>;

/// Scratch of these sums; grows once.
struct DirectScratch {
  AlignedDoubles columns;  ///< x, y, z, mu one after the other, padded to whole lanes with massless bodies
  AlignedDoubles sums;     ///< per strip: ax, ay, az
};

/// a (n x 3, m/s^2) of every body.
void direct_accelerations(const Bodies& bodies, const Softening& softening, std::span<double> a,
                          DirectScratch& scratch, const ThreadArena& arena);

/// sum_{i<j} mu_i mu_j p(r_ij), m^5/s^4: minus the potential energy times G.
double direct_potential(const Bodies& bodies, const Softening& softening, DirectScratch& scratch,
                        const ThreadArena& arena);

}  // namespace truestep::gravity
