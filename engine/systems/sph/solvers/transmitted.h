// The pressure that is read: what the liquid transmits through an area beside each particle, which is what
// walls, bodies and the weight above respond to. A solve's own numbers p_i also depend on how the neighbours
// are arranged: sums of gradients are 1.2 % too large over a lattice, over settled liquid 1.6 % too small,
// and a particle whose sums are small has a larger p for the same force. A sum over pairs (Irving & Kirkwood
// 1950; mean over directions), d the relative density, n = sum V W:
//   P_i = n_i sum (q_i + q_j) / 2 (-V dW/dr r) / dimension,  q = p / d^2.
// Where neighbours are missing (n < 0.9: walls, bodies, the surface) the particle's own q is put in their
// place. What surface tension transmits (attraction: less pressure) is added in the same way; what viscosity
// does is not in it.
#pragma once
#include <algorithm>

#include "engine/systems/sph/neighbours.h"

namespace truestep::sph {

/// Pa, of all rows of a state, into `out`. f has its places sorted and listed without walls; `pressure` and
/// `density` are the state's columns; attraction(slot, chunk, begin, end) is what other forces add to n / 2
/// over the dimension (Pa).
template <int D, class T, class Attraction>
void transmitted_pressures(Fluid<D, T>& f, const T* pressure, const T* density, const ThreadArena& arena,
                           double* out, const Attraction& attraction) {
  using W = Wide<T>;
  constexpr T kMissing = T(0.1);  // of n: where as much is missing, all of these sums is the particle's own
  for (size_t k = 0; k < f.n; ++k) {
    const T d = std::max(density[f.row(k)], static_cast<T>(1e-3));
    f.push[k] = pressure[f.row(k)] / (d * d);
  }
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    const W own = W::all(f.push[i]);
    W carried = W::zero(), whole = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      W along = W::zero();
      for (size_t a = 0; a < D; ++a)
        along = madd(c.gradient(a, k), f.nearest_image(a, W::all(f.x[a][i]) - c.of(f.x[a], k)), along);
      carried = madd(along, own + c.of(f.push, k), carried), whole += along;
    }
    const T scale = -f.unit / T(D), pairs = T(0.5) * scale * sum(carried), share = scale * sum(whole);
    const T count = f.delta[i], d = density[f.row(i)];
    const T alone = std::min(std::max((1 - count) / kMissing, T{0}), T{1});
    const T inside = count * pairs, beside = d * d * (pairs + f.push[i] * (1 - share));
    const T others = count / (2 * T(D)) * attraction(i, c, begin, end);
    out[f.row(i)] = double{inside + alone * (beside - inside) + others};
  });
}

}  // namespace truestep::sph
