// Sums over neighbour lists that the methods share.
#pragma once
#include "engine/systems/sph/fluid.h"

namespace truestep::sph {

/// How a wall responds to a particle: as a region at rest without pressure, so that the force is that of the
/// constraint on the density the kernel sums up; or as the particle's mirror image, with its pressure and the
/// opposite velocity. In both, the force does exactly the work that changes the density.
enum class Answer : uint8_t { rest, mirror };

/// f.a (m/s^2) = effect of all particles' pressures q = (p / rho0) / (rho / rho0)^2 (m^2/s^2), with
/// at_wall(slot) the pressure of a particle's mirror image behind walls.
template <int D, class T, class AtWall>
inline void push_with(Fluid<D, T>& f, const Aligned<T>& q, const ThreadArena& arena, const AtWall& at_wall) {
  f.each_sum(q, arena, [&](size_t i, const T* others) {
    const T *pull = f.pull.data() + 4 * i, *wall = f.wall.data() + 4 * i, own = q[i], image = at_wall(i);
    T* out = f.a.data() + 4 * i;
    out[2] = out[3] = 0;
    for (size_t a = 0; a < D; ++a) out[a] = -(own * pull[a] + image * wall[a] + f.unit * others[a]);
    if (!f.weighted) return;
    for (size_t a = 0; a < D; ++a) out[a] *= f.light[i];
  });
}
template <Answer A, int D, class T>
inline void push_by(Fluid<D, T>& f, const Aligned<T>& q, const ThreadArena& arena) {
  push_with(f, q, arena, [&q](size_t i) { return A == Answer::mirror ? q[i] : T{0}; });
}
/// The combined effect of pressures `mirrored`, to which walls respond as mirror images, and `rests`, to
/// which they respond at rest; leaves their sum in `both`.
template <int D, class T>
inline void push_by_both(Fluid<D, T>& f, const Aligned<T>& mirrored, const Aligned<T>& rests,
                         Aligned<T>& both, const ThreadArena& arena) {
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) both[i] = mirrored[i] + rests[i];
  });
  push_with(f, both, arena, [&mirrored](size_t i) { return mirrored[i]; });
}

/// Sum of g (u_i - u_j), with walls that do not move, for rows u of four that end with 0: the rate of a
/// particle's density (1/s). `others` is the sum of g u_j (tally_dots).
template <Answer A, int D, class T>
inline T compression(const Fluid<D, T>& f, const Aligned<T>& u, size_t i, T others) {
  const T *pull = f.pull.data() + 4 * i, *own = u.data() + 4 * i;
  T out = pull[0] * own[0] + pull[1] * own[1];
  if constexpr (D == 3) out += pull[2] * own[2];
  if constexpr (A == Answer::mirror) {
    for (size_t a = 0; a < D; ++a) out += f.wall[4 * i + a] * own[a];
  }
  return out - f.unit * others;
}

/// Particle i's factor on the velocity change that two particles of different density give each other,
/// relative to a pair of equal densities: 2 rho_j / (rho_i + rho_j), so momentum is conserved. 0 for a
/// particle that nothing moves.
template <int D, class T>
inline Wide<T> part_of_pair(const Fluid<D, T>& f, size_t i, const Chunk<T>& c, size_t k) {
  const Wide<T> own = Wide<T>::all(f.light[i]), other = c.of(f.light, k);
  return (own + own) / (own + other + Wide<T>::all(static_cast<T>(1e-9)));
}

/// f.a (m/s^2) = sum over neighbours of (slope s + weight w) (v_j - v_i), s and w (0: not kept) of the lists.
template <int D, class T>
inline void blend_velocities(Fluid<D, T>& f, T slope, T weight, const ThreadArena& arena) {
  using W = Wide<T>;
  if constexpr (kRounded<T>) {
    if (f.wide_sums && !f.weighted) {
      arena.for_blocks(f.chunks_in_use(), 4, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
          const Chunk<T>& c = f.chunks[k];
          const size_t low = k * kChunk;
          f.wide_sums->differences(c.view(), std::min(f.n - low, kChunk),
                                   {slope, weight, c.s.data(), weight > 0 ? c.w.data() : nullptr}, f.v.data(),
                                   low, f.a.data() + 4 * low);
        }
      });
      return;
    }
  }
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    const T* v = f.v.data() + 4 * i;
    W sums[D];
    for (auto& x : sums) x = W::zero();
    for (size_t k = begin; k < end; k += W::kLanes) {
      W other[4];
      c.rows_of(f.v, k, other);
      W share = W::all(slope) * load(c.s.data() + k);
      if (weight > 0) share += W::all(weight) * load(c.w.data() + k);
      if (f.weighted) share = share * part_of_pair(f, i, c, k);
      for (size_t a = 0; a < D; ++a) sums[a] = madd(share, other[a] - W::all(v[a]), sums[a]);
    }
    T* out = f.a.data() + 4 * i;
    out[2] = out[3] = 0;
    for (size_t a = 0; a < D; ++a) out[a] = sum(sums[a]);
  });
}

/// v += h a.
template <int D, class T>
inline void kick(Fluid<D, T>& f, T h, const ThreadArena& arena) {
  arena.for_blocks(4 * f.n, 4 * kBlockRows, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) f.v[k] += h * f.a[k];
  });
}

}  // namespace truestep::sph
