#include "engine/systems/sph/solvers/dfsph.h"

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

}  // namespace truestep::sph
