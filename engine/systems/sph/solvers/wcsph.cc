#include "engine/systems/sph/solvers/wcsph.h"

namespace truestep::sph {

template <int D, class T>
void Wcsph<D, T>::advance(Fluid<D, T>& f, BodiesIn<D, T>& bodies, const Vec3& gravity, double h,
                          const ThreadArena& arena) const {
  const T sound = static_cast<T>(set_.sound), step = static_cast<T>(h);
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) f.push[i] = tait(f.delta[i], sound) / (f.delta[i] * f.delta[i]);
  });
  push_by<Answer::mirror, D, T>(f, f.push, arena);
  if (set_.def.artificial_viscosity > 0) brake(f, arena);
  kick(f, step, arena);
  if (bodies.any()) bodies.template answer<Answer::mirror>(f.push), bodies.follow(f, h);
  const T g[3] = {static_cast<T>(gravity.x), static_cast<T>(gravity.y), static_cast<T>(gravity.z)};
  const T diffusion = static_cast<T>(set_.def.density_diffusion * set_.support / 2 * set_.sound);
  const T per_sound = 2 / (sound * sound);
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W sums = W::zero();
    const W own = W::all(f.delta[i]);
    for (size_t k = begin; k < end; k += W::kLanes) {
      const W other = c.of(f.delta, k);
      sums = madd(load(c.s.data() + k), own - other, sums);
    }
    const T *pull = f.pull.data() + 4 * i, *wall = f.wall.data() + 4 * i;
    T spread = 2 * sum(sums);
    // Liquid at rest is denser with depth: that part is not diffused.
    const T weight = f.fixed(i) ? per_sound : per_sound / std::max(f.lightness(i), static_cast<T>(1e-3));
    for (size_t a = 0; a < D; ++a) spread -= weight * g[a] * (pull[a] - wall[a]);
    const T rate = compression<Answer::mirror, D, T>(f, f.v, i, c.sum_dot(f.v, begin, end));
    f.source[i] = rate + 2 * f.drive[i] + diffusion * spread;
  });
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      f.delta[i] = std::min(std::max(f.delta[i] + step * f.source[i], kLeastDensity), kMostDensity);
    }
  });
}

template <int D, class T>
void Wcsph<D, T>::brake(Fluid<D, T>& f, const ThreadArena& arena) const {
  const T alpha = static_cast<T>(set_.def.artificial_viscosity * set_.support / 2 * set_.sound);
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W out[D];
    for (auto& o : out) o = W::zero();
    const W tiny = W::all(static_cast<T>(1e-20));
    for (size_t k = begin; k < end; k += W::kLanes) {
      W other[4], g[D];
      c.rows_of(f.v, k, other);
      W along = W::zero(), square = tiny;
      for (size_t a = 0; a < D; ++a) {
        g[a] = c.gradient(a, k);
        along = madd(g[a], W::all(f.v[4 * i + a]) - other[a], along);
        square = madd(g[a], g[a], square);
      }
      // Gradients point to the neighbour: approaching pairs have a positive product.
      W factor = load(c.s.data() + k) * max(along, W::zero()) / square;
      if (f.weighted) factor = factor * part_of_pair(f, i, c, k);
      for (size_t a = 0; a < D; ++a) out[a] = madd(factor, g[a], out[a]);
    }
    for (size_t a = 0; a < D; ++a) f.a[4 * i + a] += alpha * sum(out[a]);
  });
}

template class Wcsph<2, float>;
template class Wcsph<3, float>;
template class Wcsph<2, double>;
template class Wcsph<3, double>;

}  // namespace truestep::sph
