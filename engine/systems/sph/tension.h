// Surface tension as a force over the surface's thickness (Brackbill, Kothe & Zemach 1992): a = sigma kappa
// grad c / rho with the colour c, 1 in the liquid. The particles see grad c on the liquid's side alone, where
// c falls from 1 to a half: the force there is doubled. The curvature kappa is the divergence of the unit
// normals of particles that have one, over what the sum gives for a field whose divergence is known (Adami,
// Hu & Adams 2010, equation 20). Walls belong to the liquid's outside: drops bead on them.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/systems/sph/passes.h"

namespace truestep::sph {

/// Over the kernel's radius: gradients of the colour below this are disorder inside the liquid, not its
/// surface.
inline constexpr double kLeastGradient = 0.3;

/// Adds the force of a tension (m^3/s^2, over the density) to f.a (m/s^2). Needs slopes.
template <int D, class T>
inline void draw_surface(Fluid<D, T>& f, T tension, T support, const ThreadArena& arena) {
  using W = Wide<T>;
  f.normal.resize(4 * f.n);
  const T least = static_cast<T>(kLeastGradient) / support;
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const T *pull = f.pull.data() + 4 * i, *wall = f.wall.data() + 4 * i;
      T* out = f.normal.data() + 4 * i;
      T square = 0;
      out[2] = 0;
      for (size_t a = 0; a < D; ++a) out[a] = pull[a] - wall[a], square += out[a] * out[a];
      const T size = std::sqrt(square);
      const bool surface = size > least;
      for (size_t a = 0; a < D; ++a) out[a] = surface ? out[a] / size : T{0};
      out[3] = surface ? T{1} : T{0};
    }
  });
  const W none = W::all(-static_cast<T>(1e-12) / (support * support));
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    const T* own = f.normal.data() + 4 * i;
    if (own[3] == 0) return;
    W turn = W::zero(), known = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      W other[4], along = W::zero(), square = W::zero();
      gather_rows4(f.normal.data(), c.slot.data() + k, other);
      for (size_t a = 0; a < D; ++a) {
        const W g = load(c.g[a].data() + k);
        along = madd(g, other[a] - W::all(own[a]), along), square = madd(g, g, square);
      }
      turn = madd(other[3], along, turn);
      known = madd(other[3], square / min(load(c.s.data() + k), none), known);
    }
    // Both are negative where the surface bulges.
    const T over = sum(known);
    if (!(over < 0)) return;
    const T curvature = D * sum(turn) / over;
    const T* pull = f.pull.data() + 4 * i;
    const T* wall = f.wall.data() + 4 * i;
    const T scale = 2 * tension * curvature * f.lightness(i);
    for (size_t a = 0; a < D; ++a) f.a[4 * i + a] += scale * (pull[a] - wall[a]);
  });
}

}  // namespace truestep::sph
