// Surface tension. `cohesion`: pairs attract each other (kernels/sph/cohesion.h); a particle at the surface
// lacks neighbours on one side and is drawn in, pressure maintains the density. `interface`: the surface has
// an energy (kernels/sph/interface.h). Walls do not attract: drops bead on them. A force from the colour
// field's curvature (Brackbill, Kothe & Zemach 1992) was tried: the normals of particles that leave the
// surface are noise, and fed energy to drops until they burst.
#pragma once
#include "engine/kernels/sph/cohesion.h"
#include "engine/kernels/sph/interface.h"
#include "engine/systems/sph/passes.h"

namespace truestep::sph {

/// Offsets to neighbours: gradients, divided by whose size they are directions (g / size), and distances in
/// kernel radii. Padding has direction 0 and distance 1.
template <int D, class T>
struct Ways {
  Wide<T> g[D], size, q;

  /// Needs slopes, or distances where gradients are rounded.
  Ways(const Chunk<T>& c, size_t k, T support) {
    using W = Wide<T>;
    // Gradients point to the neighbour.
    const W tiny = W::all(kRounded<T> ? static_cast<T>(1e-20) : static_cast<T>(1e-6) / support);
    W square = W::zero();
    for (size_t a = 0; a < D; ++a) g[a] = c.gradient(a, k), square = madd(g[a], g[a], square);
    size = max(sqrt(square), tiny);
    if constexpr (kRounded<T>) {
      q = load(c.q.data() + k);
    } else {
      // Gradients are slopes times offsets.
      const W slope = min(load(c.s.data() + k), W::zero() - tiny * tiny);
      q = min(size * W::all(-1 / support) / slope, W::all(1));
    }
  }
};

/// Adds `strength` sum C(|x_ij| / H) x_ji / |x_ij| to f.a (m/s^2).
template <int D, class T>
inline void draw_together(Fluid<D, T>& f, T strength, T support, const ThreadArena& arena) {
  using W = Wide<T>;
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W sums[D];
    for (auto& s : sums) s = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      const Ways<D, T> way(c, k, support);
      const W by = cohesion(way.q) / way.size;
      for (size_t a = 0; a < D; ++a) sums[a] = madd(by, way.g[a], sums[a]);
    }
    const T scale = strength * f.lightness(i);
    for (size_t a = 0; a < D; ++a) f.a[4 * i + a] += scale * sum(sums[a]);
  });
}

/// Adds the force of the interface's energy, with `strength` = e / (H m) (m/s^2), to f.a.
template <int D, class T>
inline void shrink_interface(Fluid<D, T>& f, T strength, const PlaneInterface& plane, T support,
                             const ThreadArena& arena) {
  using W = Wide<T>;
  f.normal.resize(4 * f.n);
  const W one = W::all(1), hold = W::all(static_cast<T>(plane.hold));
  const T softness = static_cast<T>(plane.softness), per = static_cast<T>(1 / plane.whole);
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W sums[D], near = W::zero();
    for (auto& s : sums) s = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      const Ways<D, T> way(c, k, support);
      const W p = one - way.q * way.q, psi = way.q * p * p / way.size;
      near = madd(p * p, p, near);
      for (size_t a = 0; a < D; ++a) sums[a] = madd(psi, way.g[a], sums[a]);
    }
    T* m = f.normal.data() + 4 * i;
    T square = softness * softness;
    m[2] = 0, m[3] = 2 * (1 - (1 + sum(near)) * per);
    for (size_t a = 0; a < D; ++a) m[a] = sum(sums[a]), square += m[a] * m[a];
    const T size = 1 / std::sqrt(square);
    for (size_t a = 0; a < D; ++a) m[a] *= size;
  });
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    const T* own = f.normal.data() + 4 * i;
    W sums[D];
    for (auto& s : sums) s = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      const Ways<D, T> way(c, k, support);
      W other[4], along = W::zero();
      c.rows_of(f.normal, k, other);
      for (size_t a = 0; a < D; ++a) {
        other[a] = W::all(own[a]) - other[a];
        along = madd(other[a], way.g[a], along);
      }
      along = along / way.size;
      const W square = way.q * way.q, p = one - square;
      const W by =
          p * (hold * (W::all(own[3]) + other[3]) * way.q * p - W::all(4) * square * along) / way.size;
      for (size_t a = 0; a < D; ++a) sums[a] += madd(p * p, other[a], by * way.g[a]);
    }
    const T scale = strength * f.lightness(i);
    for (size_t a = 0; a < D; ++a) f.a[4 * i + a] += scale * sum(sums[a]);
  });
}

}  // namespace truestep::sph
