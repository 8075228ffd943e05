#include "engine/systems/sph/solvers/tension.h"

#include "engine/kernels/sph/cohesion.h"
#include "engine/kernels/sph/interface.h"
#include "engine/systems/sph/solvers/passes.h"
#include "engine/systems/sph/solvers/read_pressures.h"
#include "engine/systems/sph/solvers/transmitted.h"

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

template <int D, class T>
void draw_together(Fluid<D, T>& f, T strength, T support, const ThreadArena& arena) {
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

template <int D, class T>
void shrink_interface(Fluid<D, T>& f, T strength, const PlaneInterface& plane, T support,
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

template <int D, class T>
void read_pressures(const Setting& set, Fluid<D, T>& f, const State& s, const ThreadArena& arena,
                    double* out) {
  const SphDef& d = set.def;
  const bool draws = d.surface_tension > 0 && d.surface_tension_model == Tension::cohesion;
  const bool shrinks = d.surface_tension > 0 && d.surface_tension_model == Tension::interface;
  const T strength = static_cast<T>(set.cohesion), support = static_cast<T>(set.support);
  if (shrinks) find_interface(f, *set.interface, support, arena);
  transmitted_pressures(f, s.span<T>(columns::pressure).data(), s.span<T>(columns::density).data(), arena,
                        out, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
                          const T rest = static_cast<T>(d.density);
                          if (draws) return rest * work_of_drawing<D, T>(c, begin, end, strength, support);
                          if (!shrinks) return T{0};
                          return rest *
                                 work_of_shrinking(f, i, c, begin, end, strength, *set.interface, support);
                        });
}

template void draw_together(Fluid<2, float>&, float, float, const ThreadArena&);
template void draw_together(Fluid<3, float>&, float, float, const ThreadArena&);
template void draw_together(Fluid<2, double>&, double, double, const ThreadArena&);
template void draw_together(Fluid<3, double>&, double, double, const ThreadArena&);
template void shrink_interface(Fluid<2, float>&, float, const PlaneInterface&, float, const ThreadArena&);
template void shrink_interface(Fluid<3, float>&, float, const PlaneInterface&, float, const ThreadArena&);
template void shrink_interface(Fluid<2, double>&, double, const PlaneInterface&, double, const ThreadArena&);
template void shrink_interface(Fluid<3, double>&, double, const PlaneInterface&, double, const ThreadArena&);
template void read_pressures(const Setting&, Fluid<2, float>&, const State&, const ThreadArena&, double*);
template void read_pressures(const Setting&, Fluid<3, float>&, const State&, const ThreadArena&, double*);
template void read_pressures(const Setting&, Fluid<2, double>&, const State&, const ThreadArena&, double*);
template void read_pressures(const Setting&, Fluid<3, double>&, const State&, const ThreadArena&, double*);

}  // namespace truestep::sph
