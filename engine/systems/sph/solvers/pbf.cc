#include "engine/systems/sph/solvers/pbf.h"

namespace truestep::sph {

template <int D, class T>
void Pbf<D, T>::correct(Fluid<D, T>& f, BodiesIn<D, T>& bodies, double t, double h,
                        const ThreadArena& arena) const {
  const T relief = static_cast<T>(kRelief / (set_.def.spacing * set_.def.spacing));
  const bool any = bodies.any();
  std::fill(f.flow.begin(), f.flow.end(), T{0});
  for (int k = 0; k < set_.def.pbf_iterations; ++k) {
    if (k > 0) renew(f, bodies, t, arena);
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        // Among neighbours that nothing moves either, it would have no stiffness.
        if (f.fixed(i)) {
          f.push[i] = 0;
          continue;
        }
        f.push[i] = std::max(f.delta[i] - 1, T{0}) / (f.stiffness[i] + relief * f.lightness(i) +
                                                      (any ? bodies.template give<Answer::rest>(i) : T{0}));
        f.flow[i] += f.push[i];
      }
    });
    push_by<Answer::rest, D, T>(f, f.push, arena);
    if (any) bodies.template answer<Answer::rest>(f.push), bodies.shift(h);
    if (set_.def.artificial_pressure > 0) part(f, arena);
    shift(f, t, static_cast<T>(1 / h), arena);
  }
  // Densities at the current positions.
  renew(f, bodies, t, arena);
}

template <int D, class T>
void Pbf<D, T>::renew(Fluid<D, T>& f, BodiesIn<D, T>& bodies, double t, const ThreadArena& arena) const {
  walls_.shares(f, t, arena);
  if (bodies.any()) bodies.touch(f, arena);
  neighbours_.renew(f, arena);
}

template <int D, class T>
void Pbf<D, T>::part(Fluid<D, T>& f, const ThreadArena& arena) const {
  const T strength = static_cast<T>(set_.def.artificial_pressure * set_.def.spacing * set_.def.spacing);
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W sums[D];
    for (auto& s : sums) s = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      const W ratio = load(c.w.data() + k) * W::all(per_near_), square = ratio * ratio;
      W p = W::all(strength) * square * square;
      if (f.weighted) p = p * part_of_pair(f, i, c, k);
      for (size_t a = 0; a < D; ++a) sums[a] = madd(p, c.gradient(a, k), sums[a]);
    }
    for (size_t a = 0; a < D; ++a) f.a[4 * i + a] -= f.unit * sum(sums[a]);
  });
}

template <int D, class T>
void Pbf<D, T>::shift(Fluid<D, T>& f, double t, T per_h, const ThreadArena& arena) const {
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      T place[3] = {}, unused[3] = {};
      for (size_t a = 0; a < D; ++a) place[a] = f.x[a][i] + f.a[4 * i + a];
      walls_.keep_inside(place, unused, t);
      for (size_t a = 0; a < D; ++a) {
        f.v[4 * i + a] += (place[a] - f.x[a][i]) * per_h;
        f.x[a][i] = place[a];
      }
    }
  });
}

template class Pbf<2, float>;
template class Pbf<3, float>;
template class Pbf<2, double>;
template class Pbf<3, double>;

}  // namespace truestep::sph
