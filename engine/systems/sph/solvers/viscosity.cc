#include "engine/systems/sph/solvers/viscosity.h"

namespace truestep::sph {

template <int D, class T>
int ImplicitViscosity<D, T>::solve(Fluid<D, T>& f, double t, double h, const ThreadArena& arena) const {
  for (auto* c : {&f.rest, &f.way, &f.image, &f.scale}) c->resize(4 * f.n);
  const double strength = (turns() ? 2 * (D + 2) : 2) * set_.def.viscosity * h;
  if (holds()) hold(f, t, h, arena);
  precondition(f, static_cast<T>(strength), arena);
  multiply(f, f.v, static_cast<T>(strength), arena);
  // The residual v* - (1 + h A) v at v = v*.
  const double start = sum_of(f, arena, [&](size_t i, size_t k) {
    T left = f.v[k] - f.image[k];
    if (holds()) left += f.hold[kHold * i + 6 + k % 4];
    f.rest[k] = f.fixed(i) ? T{0} : left;
    f.way[k] = f.scale[k] * f.rest[k];
    return double{f.rest[k]} * double{f.way[k]};
  });
  double now = start;
  int iterations = 0;
  const double enough = start * kTolerance * kTolerance;
  while (now > enough && iterations < set_.def.max_iterations) {
    multiply(f, f.way, static_cast<T>(strength), arena);
    const double across = sum_of(f, arena, [&](size_t i, size_t k) {
      if (f.fixed(i)) f.image[k] = 0;
      return double{f.way[k]} * double{f.image[k]};
    });
    if (!(across > 0)) break;
    const T along = static_cast<T>(now / across);
    const double next = sum_of(f, arena, [&](size_t, size_t k) {
      f.v[k] += along * f.way[k], f.rest[k] -= along * f.image[k];
      return double{f.rest[k]} * double{f.scale[k] * f.rest[k]};
    });
    const T turn = static_cast<T>(next / now);
    sum_of(f, arena, [&](size_t, size_t k) {
      f.way[k] = f.scale[k] * f.rest[k] + turn * f.way[k];
      return 0.0;
    });
    now = next, ++iterations;
  }
  return iterations;
}

template <int D, class T>
void ImplicitViscosity<D, T>::multiply(Fluid<D, T>& f, const Aligned<T>& u, T strength,
                                       const ThreadArena& arena) const {
  const bool turning = turns();
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W sums[D];
    for (auto& s : sums) s = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      W other[4], g[D], along = W::zero();
      c.rows_of(u, k, other);
      for (size_t a = 0; a < D; ++a) {
        g[a] = c.gradient(a, k), other[a] = W::all(u[4 * i + a]) - other[a];
        along = madd(g[a], other[a], along);
      }
      const W by = weight(f, i, c, k, g, strength);
      for (size_t a = 0; a < D; ++a) sums[a] = madd(by, turning ? along * g[a] : other[a], sums[a]);
    }
    T* out = f.image.data() + 4 * i;
    const T* own = u.data() + 4 * i;
    out[2] = out[3] = 0;
    for (size_t a = 0; a < D; ++a) out[a] = own[a] + sum(sums[a]);
    if (!holds() || !(f.wall[4 * i + 3] > 0)) return;
    const T* m = f.hold.data() + kHold * i;
    out[0] += m[0] * own[0] + m[3] * own[1];
    out[1] += m[3] * own[0] + m[1] * own[1];
    if constexpr (D == 3) {
      out[0] += m[4] * own[2], out[1] += m[5] * own[2];
      out[2] += m[4] * own[0] + m[5] * own[1] + m[2] * own[2];
    }
  });
}

template <int D, class T>
void ImplicitViscosity<D, T>::precondition(Fluid<D, T>& f, T strength, const ThreadArena& arena) const {
  const bool turning = turns();
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W sums[D];
    for (auto& s : sums) s = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      W g[D];
      for (size_t a = 0; a < D; ++a) g[a] = c.gradient(a, k);
      const W by = weight(f, i, c, k, g, strength);
      for (size_t a = 0; a < D; ++a) sums[a] = madd(by, turning ? g[a] * g[a] : W::all(1), sums[a]);
    }
    T* out = f.scale.data() + 4 * i;
    out[2] = out[3] = 0;
    for (size_t a = 0; a < D; ++a) {
      const T walls = holds() ? f.hold[kHold * i + a] : T{0};
      out[a] = 1 / (1 + sum(sums[a]) + walls);
    }
  });
}

template <int D, class T>
void ImplicitViscosity<D, T>::hold(Fluid<D, T>& f, double t, double h, const ThreadArena& arena) const {
  f.hold.resize(kHold * f.n);
  const double nu = set_.def.viscosity * h, least = kLeastGap * set_.def.spacing;
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      double m[kHold] = {};
      const double x[3] = {double{f.x[0][i]}, double{f.x[1][i]}, D == 3 ? double{f.x[2][i]} : 0};
      walls_.near(x, t, [&](double d, const Vec3& n, const Vec3& velocity, double full) {
        const double by = nu * full * set_.wall.friction(d, least);
        const Vec3 drag = (velocity - n * dot(velocity, n)) * by;
        m[0] += by * (1 - n.x * n.x), m[1] += by * (1 - n.y * n.y), m[2] += by * (1 - n.z * n.z);
        m[3] -= by * n.x * n.y, m[4] -= by * n.x * n.z, m[5] -= by * n.y * n.z;
        m[6] += drag.x, m[7] += drag.y, m[8] += drag.z;
      });
      for (size_t a = 0; a < kHold; ++a) f.hold[kHold * i + a] = static_cast<T>(m[a]);
    }
  });
}

template class ImplicitViscosity<2, float>;
template class ImplicitViscosity<3, float>;
template class ImplicitViscosity<2, double>;
template class ImplicitViscosity<3, double>;

}  // namespace truestep::sph
