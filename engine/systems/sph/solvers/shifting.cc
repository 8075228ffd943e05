#include "engine/systems/sph/solvers/shifting.h"

namespace truestep::sph {

template <int D, class T>
void Shifting<D, T>::shift(Fluid<D, T>& f, double way, bool carried, const ThreadArena& arena) const {
  const T scale = static_cast<T>(std::min(set_.shifting * way * set_.support, widest_));
  const T most = static_cast<T>(kMost * set_.def.spacing);
  f.shift.resize(4 * f.n);
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W sums[D];
    for (auto& s : sums) s = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      const W ratio = load(c.w.data() + k) * W::all(per_near_), square = ratio * ratio;
      const W by = W::all(kNear) * square * square;
      for (size_t a = 0; a < D; ++a) sums[a] = madd(by, c.gradient(a, k), sums[a]);
    }
    const T part = f.fixed(i) ? T{0} : scale * f.inside[i];
    T* out = f.shift.data() + 4 * i;
    T square = 0;
    out[2] = out[3] = 0;
    for (size_t a = 0; a < D; ++a) {
      out[a] = -part * (f.pull[4 * i + a] + f.unit * sum(sums[a])), square += out[a] * out[a];
    }
    if (square > most * most) {
      const T less = most / std::sqrt(square);
      for (size_t a = 0; a < D; ++a) out[a] *= less;
    }
  });
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    const T *by = f.shift.data() + 4 * i, *v = f.v.data() + 4 * i;
    W sums[D], denser = W::zero();
    for (auto& s : sums) s = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      W other[4], along = W::zero();
      c.rows_of(f.v, k, other);
      for (size_t a = 0; a < D; ++a) along = madd(c.gradient(a, k), W::all(by[a]), along);
      for (size_t a = 0; a < D; ++a) sums[a] = madd(along, other[a] - W::all(v[a]), sums[a]);
      if (carried) denser = madd(along, c.of(f.delta, k) - W::all(f.delta[i]), denser);
    }
    T* out = f.a.data() + 4 * i;
    out[2] = out[3] = 0;
    for (size_t a = 0; a < D; ++a) out[a] = f.unit * sum(sums[a]);
    if (carried) f.source[i] = f.unit * sum(denser);
  });
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t k = 4 * begin; k < 4 * end; ++k) f.v[k] += f.a[k];
    if (!carried) return;
    for (size_t i = begin; i < end; ++i) f.delta[i] += f.source[i];
  });
}

template <int D, class T>
double Shifting<D, T>::stiffest() const {
  const double s = set_.def.spacing;
  const int reach = static_cast<int>(set_.def.support) + 1, deep = D == 3 ? reach : 0;
  // grad C along x at the place dx of one whose row, or every other one around it, lies at 0.
  const auto pull = [&](double dx, bool all) {
    double sum = 0;
    for (int x = -reach; x <= reach; ++x) {
      for (int y = -reach; y <= reach; ++y) {
        for (int z = -deep; z <= deep; ++z) {
          const bool moved = (all ? x + y + z : x) % 2 == 0;
          const double way = moved ? -x * s : dx - x * s, across = s * s * (y * y + z * z);
          const double r = std::sqrt(way * way + across);
          if (r == 0 || r >= set_.support) continue;
          const SmoothingValue<double> at = smoothing_at(set_.def.kernel, r / set_.support);
          const double ratio = set_.kernel_w * at.w[0] * double{per_near_}, square = ratio * ratio;
          sum += set_.kernel_s * at.s[0] * way * (1 + double{kNear} * square * square);
        }
      }
    }
    return std::abs(sum);
  };
  const double little = 1e-3 * s;
  return std::max(pull(little, false), pull(little, true)) / little;
}

template class Shifting<2, float>;
template class Shifting<3, float>;
template class Shifting<2, double>;
template class Shifting<3, double>;

}  // namespace truestep::sph
