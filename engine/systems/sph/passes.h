// Sums over lists of neighbours that the methods share.
#pragma once
#include "engine/systems/sph/fluid.h"

namespace truestep::sph {

/// How a wall answers a particle: as a region at rest in which there is no pressure, so that the force is
/// that of the constraint on the density that the kernel sums up, or as the particle's mirror image, with its
/// pressure and the opposite velocity. Either does exactly the work that the density takes up.
enum class Answer : uint8_t { rest, mirror };

/// m/s^2 into f.a: what pressures q = (p / rho0) / (rho / rho0)^2 (m^2/s^2) of all particles do.
template <Answer A, int D, class T>
inline void push_by(Fluid<D, T>& f, const Aligned<T>& q, const ThreadArena& arena) {
  using W = Wide<T>;
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W sums[D];
    for (auto& s : sums) s = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      const W other = c.of(q, k);
      for (size_t a = 0; a < D; ++a) sums[a] = madd(c.gradient(a, k), other, sums[a]);
    }
    const T *pull = f.pull.data() + 4 * i, *wall = f.wall.data() + 4 * i, own = q[i];
    T* out = f.a.data() + 4 * i;
    out[2] = out[3] = 0;
    for (size_t a = 0; a < D; ++a)
      out[a] = -(own * (A == Answer::mirror ? pull[a] + wall[a] : pull[a]) + f.unit * sum(sums[a]));
    if (!f.weighted) return;
    for (size_t a = 0; a < D; ++a) out[a] *= f.light[i];
  });
}

/// Sum of g (u_i - u_j) with walls that do not move, for rows u of four: the rate of a particle's density
/// (1/s).
template <Answer A, int D, class T>
inline T compression(const Fluid<D, T>& f, const Aligned<T>& u, size_t i, const Chunk<T>& c, size_t begin,
                     size_t end) {
  using W = Wide<T>;
  // Two sums, so that one product need not wait for the one before.
  W sums[2] = {W::zero(), W::zero()};
  for (size_t k = begin; k < end; k += W::kLanes) {
    W other[4];
    c.rows_of(u, k, other);
    sums[0] = madd(c.gradient(0, k), other[0], sums[0]);
    sums[1] = madd(c.gradient(1, k), other[1], sums[1]);
    if constexpr (D == 3) sums[0] = madd(c.gradient(2, k), other[2], sums[0]);
  }
  const T *pull = f.pull.data() + 4 * i, *own = u.data() + 4 * i;
  T out = pull[0] * own[0] + pull[1] * own[1];
  if constexpr (D == 3) out += pull[2] * own[2];
  if constexpr (A == Answer::mirror) {
    for (size_t a = 0; a < D; ++a) out += f.wall[4 * i + a] * own[a];
  }
  return out - f.unit * sum(sums[0] + sums[1]);
}

/// Of what two particles of different density do to each other's velocities, as a share of what two alike do,
/// the part of particle i: 2 rho_j / (rho_i + rho_j), so that momentum is kept. 0 for what nothing moves.
template <int D, class T>
inline Wide<T> part_of_pair(const Fluid<D, T>& f, size_t i, const Chunk<T>& c, size_t k) {
  const Wide<T> own = Wide<T>::all(f.light[i]), other = c.of(f.light, k);
  return (own + own) / (own + other + Wide<T>::all(static_cast<T>(1e-9)));
}

/// v += h a.
template <int D, class T>
inline void kick(Fluid<D, T>& f, T h, const ThreadArena& arena) {
  arena.for_blocks(4 * f.n, 4 * kBlockRows, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) f.v[k] += h * f.a[k];
  });
}

}  // namespace truestep::sph
