// The three ways to find pressures (dfsph.h, wcsph.h, pbf.h), each for both dimensions and precisions.
#include "engine/systems/sph/solvers/dfsph.h"
#include "engine/systems/sph/solvers/pbf.h"
#include "engine/systems/sph/solvers/wcsph.h"

namespace truestep::sph {

template <int D, class T>
auto Dfsph<D, T>::solve(Fluid<D, T>& f, BodiesIn<D, T>& bodies, const Pace& pace,
                        const ThreadArena& arena) const -> Solved {
  const double h = pace.h, error = h * h / (pace.part * pace.tolerance);
  const T most = static_cast<T>(kMostAtOnce * pace.share), part = static_cast<T>(pace.part);
  const T step = static_cast<T>(h), per_step = 1 / step,
          closing = static_cast<T>(set_.closed ? 0 : kClosing / h);
  begin_from(f, f.flow, arena);
  push_by<Answer::mirror>(f, f.flow, arena);
  move<Answer::mirror>(f, bodies, f.flow, h, arena);
  Solved out;
  out.flow = relax<Answer::mirror>(f, bodies, f.flow, error, arena, [&](size_t i, T others) {
    const T rate = compression<Answer::mirror, D, T>(f, f.v, i, others) + 2 * f.drive[i];
    return per_step * (rate + closing * std::min(f.delta[i] - static_cast<T>(kGap), T{0}));
  });
  if (set_.closed) {
    push_by<Answer::mirror>(f, f.change, arena);
    move<Answer::mirror>(f, bodies, f.change, h, arena);
    return out;
  }
  // The result of the first solve and the start of the second push in one pass.
  begin_from(f, f.push, arena);
  push_by_both(f, f.change, f.push, f.next, arena);
  if (bodies.any()) {
    bodies.template answer<Answer::mirror>(f.change), bodies.follow(f, h);
  }
  move<Answer::rest>(f, bodies, f.push, h, arena);
  out.push = relax<Answer::rest>(f, bodies, f.push, error, arena, [&](size_t i, T others) {
    const T rate = compression<Answer::rest, D, T>(f, f.v, i, others) + f.drive[i];
    return per_step * (per_step * part * std::min(f.delta[i] - 1, most) + rate);
  });
  push_by<Answer::rest>(f, f.change, arena);
  move<Answer::rest>(f, bodies, f.change, h, arena);
  return out;
}

template <int D, class T>
void Dfsph<D, T>::begin_from(Fluid<D, T>& f, Aligned<T>& q, const ThreadArena& arena) {
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (f.fixed(i)) q[i] = 0;
      f.start[i] = f.iterate[i] = q[i];
    }
  });
}

template <int D, class T>
void Dfsph<D, T>::center(Fluid<D, T>& f, Aligned<T>& q, const ThreadArena& arena) {
  const auto all = f.tally(arena, [&](size_t i) { return std::array<double, 3>{0, 0, double{q[i]}}; });
  const T mean = static_cast<T>(all.third / static_cast<double>(f.n));
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) q[i] -= mean;
  });
}

template <int D, class T>
void Dfsph<D, T>::go_to(Fluid<D, T>& f, Aligned<T>& q, const Aligned<T>& to, const ThreadArena& arena) {
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) q[i] = to[i], f.change[i] = to[i] - f.start[i];
  });
}

template class Dfsph<2, float>;
template class Dfsph<3, float>;
template class Dfsph<2, double>;
template class Dfsph<3, double>;

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
