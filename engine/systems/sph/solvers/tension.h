// Surface tension. `cohesion`: pairs attract each other (kernels/sph/cohesion.h); a particle at the surface
// lacks neighbours on one side and is drawn in, pressure maintains the density. `interface`: the surface has
// an energy (kernels/sph/interface.h). Walls do not attract: drops bead on them. A force from the colour
// field's curvature (Brackbill, Kothe & Zemach 1992) was tried: the normals of particles that leave the
// surface are noise, and fed energy to drops until they burst.
#pragma once
#include "engine/kernels/sph/cohesion.h"
#include "engine/kernels/sph/interface.h"
#include "engine/systems/sph/solvers/passes.h"

namespace truestep::sph {

/// Offsets to neighbours: gradients g with their sizes, so that g / size is the direction, and distances in
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

/// Sum over the pairs of particle i of what draw_together() adds, times the offset from the neighbour
/// (m^2/s^2).
template <int D, class T>
inline T work_of_drawing(const Chunk<T>& c, size_t begin, size_t end, T strength, T support) {
  using W = Wide<T>;
  W out = W::zero();
  for (size_t k = begin; k < end; k += W::kLanes) {
    const Ways<D, T> way(c, k, support);
    out = out - cohesion(way.q) * way.q;
  }
  return strength * support * sum(out);
}

/// Finds the interface: its normals and what the kernel sum lacks there, into f.normal.
template <int D, class T>
inline void find_interface(Fluid<D, T>& f, const PlaneInterface& plane, T support, const ThreadArena& arena) {
  using W = Wide<T>;
  f.normal.resize(4 * f.n);
  const W one = W::all(1);
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
}

/// Effect of neighbours on particle i by the energy of the interface: p^2 other + by g, whose component along
/// the offset to them is `along`.
template <int D, class T>
struct InterfacePair {
  Wide<T> other[4], p, by, along;

  InterfacePair(const Fluid<D, T>& f, size_t i, const Chunk<T>& c, size_t k, const Ways<D, T>& way,
                const Wide<T>& hold) {
    using W = Wide<T>;
    const T* own = f.normal.data() + 4 * i;
    W across = W::zero();
    c.rows_of(f.normal, k, other);
    for (size_t a = 0; a < D; ++a) {
      other[a] = W::all(own[a]) - other[a];
      across = madd(other[a], way.g[a], across);
    }
    across = across / way.size;
    const W square = way.q * way.q;
    p = W::all(1) - square;
    by = p * (hold * (W::all(own[3]) + other[3]) * way.q * p - W::all(4) * square * across) / way.size;
    along = p * p * across + by * way.size;
  }
};

/// Adds the forces of the interface's energy to f.a; `strength` = e / (H m) (m/s^2).
template <int D, class T>
inline void shrink_interface(Fluid<D, T>& f, T strength, const PlaneInterface& plane, T support,
                             const ThreadArena& arena) {
  using W = Wide<T>;
  find_interface(f, plane, support, arena);
  const W hold = W::all(static_cast<T>(plane.hold));
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W sums[D];
    for (auto& s : sums) s = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      const Ways<D, T> way(c, k, support);
      const InterfacePair<D, T> pair(f, i, c, k, way, hold);
      for (size_t a = 0; a < D; ++a) sums[a] += madd(pair.p * pair.p, pair.other[a], pair.by * way.g[a]);
    }
    const T scale = strength * f.lightness(i);
    for (size_t a = 0; a < D; ++a) f.a[4 * i + a] += scale * sum(sums[a]);
  });
}

/// Like work_of_drawing(), for shrink_interface(); call find_interface() first.
template <int D, class T>
inline T work_of_shrinking(const Fluid<D, T>& f, size_t i, const Chunk<T>& c, size_t begin, size_t end,
                           T strength, const PlaneInterface& plane, T support) {
  using W = Wide<T>;
  const W hold = W::all(static_cast<T>(plane.hold));
  W out = W::zero();
  for (size_t k = begin; k < end; k += W::kLanes) {
    const Ways<D, T> way(c, k, support);
    out = out - InterfacePair<D, T>(f, i, c, k, way, hold).along * way.q;
  }
  return strength * support * sum(out);
}

}  // namespace truestep::sph
