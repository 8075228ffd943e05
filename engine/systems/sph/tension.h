// Surface tension: the cohesion of all pairs (kernels/sph/cohesion.h). What a particle at the surface lacks
// on one side draws it in; pressure keeps the density. Walls draw nothing: drops bead on them. A force by the
// colour's curvature (Brackbill, Kothe & Zemach 1992) was tried: normals of particles that leave the surface
// are noise, and fed drops energy until they burst.
#pragma once
#include "engine/kernels/sph/cohesion.h"
#include "engine/systems/sph/passes.h"

namespace truestep::sph {

/// Adds `strength` sum C(|x_ij| / H) x_ji / |x_ij| to f.a (m/s^2). Needs slopes, and of
/// rounded gradients distances.
template <int D, class T>
inline void draw_together(Fluid<D, T>& f, T strength, T support, const ThreadArena& arena) {
  using W = Wide<T>;
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W sums[D];
    for (auto& s : sums) s = W::zero();
    // Gradients point to the neighbour.
    const W tiny = W::all(kRounded<T> ? static_cast<T>(1e-20) : static_cast<T>(1e-6) / support);
    for (size_t k = begin; k < end; k += W::kLanes) {
      W g[D], square = W::zero();
      for (size_t a = 0; a < D; ++a) g[a] = c.gradient(a, k), square = madd(g[a], g[a], square);
      const W size = max(sqrt(square), tiny);
      W q;
      if constexpr (kRounded<T>) {
        q = load(c.q.data() + k);
      } else {
        // Gradients are slopes times offsets.
        const W slope = min(load(c.s.data() + k), W::zero() - tiny * tiny);
        q = min(size * W::all(-1 / support) / slope, W::all(1));
      }
      const W by = cohesion(q) / size;
      for (size_t a = 0; a < D; ++a) sums[a] = madd(by, g[a], sums[a]);
    }
    const T scale = strength * f.lightness(i);
    for (size_t a = 0; a < D; ++a) f.a[4 * i + a] += scale * sum(sums[a]);
  });
}

}  // namespace truestep::sph
