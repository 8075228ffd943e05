// Distance constraints C_s = |x_{s+1} - x_s| - L_s along a chain of points, solved directly: with unit
// directions n_s the system of compliance.h is tridiagonal,
//   (w_s + w_{s+1} + a_s) l_s - w_s (n_s . n_{s-1}) l_{s-1} - w_{s+1} (n_s . n_{s+1}) l_{s+1} = b_s,
//   a = alpha~ / (1 + gamma),   b = (-C - alpha~ lambda - gamma dC) / (1 + gamma),
// and one elimination carries a load from one end to the other, whatever the length, the stiffness and the
// mass ratio. A chain of one link is the usual single constraint (Macklin et al. 2016, eq. 18). As many
// chains as there are lanes are solved side by side; they share no point. Rows of points are (x, y, z,
// inverse mass): positions, or displacements from positions whose differences are given, which resolve far
// smaller steps in floats. Directions are those at the start of the call. Their rotation is left to the next
// substep, as a symplectic Euler step of the sideways force T / l of a link under the tension T: stable
// while, at every point,
//   q = w sum (-lambda) / l = h^2 w sum T / l < 2     (h^2 omega^2 <= 2 q < 4 for the chain's fastest wave).
#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>

#include "engine/kernels/xpbd/compliance.h"
#include "engine/math/wide_rows.h"

namespace truestep::xpbd {

/// Chains of at most `links` links; a shorter one is padded with links that are kIdle, at a row of their own
/// with inverse mass 0.
template <class T>
struct Chains {
  size_t links = 0;
  const uint32_t* points = nullptr;  ///< (links + 1) x lanes
  const T* rest = nullptr;           ///< links x lanes, m
  const T* compliance = nullptr;     ///< links x lanes, m/N
  const T* damping = nullptr;        ///< links x lanes, s: gamma times h; or null: undamped
  T* lambda = nullptr;               ///< links x lanes, added to; null: zero so far, and not needed later
  const T* base = nullptr;           ///< links x 3 x lanes: x_{s+1} - x_s where rows are 0; null: 0
};

/// Scratch for one link of every lane.
template <class T>
struct ChainRow {
  Wide<T> x, y, z, per_length, pivot, side,
      right;  // direction, 1 / l, 1 / pivot, off-diagonal, right-hand side
};

/// Moves the points of all rows by `relax` (1: a full step) times the correction. `before`, for damping, are
/// the rows at the substep's start. `scratch` has c.links rows. Returns the largest q of all points.
template <class T>
T solve_chains(const Chains<T>& c, const PerStep<T>& per, const T* before, T relax, T* rows,
               ChainRow<T>* scratch) {
  using W = Wide<T>;
  constexpr int kLanes = W::kLanes;
  const auto load = [](const T* p) {
    W r;
    for (int i = 0; i < kLanes; ++i) r.v[i] = p[i];
    return r;
  };
  // A straight chain held at both ends without compliance has no unique tension: regularised.
  const W regular(1 + 8 * std::numeric_limits<T>::epsilon()), zero = W::zero(), one(T(1)), per_h2(per.h2);
  W p[4], q[4], p_old[4], q_old[4];
  gather_rows4(rows, c.points, p);
  if (c.damping) gather_rows4(before, c.points, p_old);
  W nx = zero, ny = zero, nz = zero, pivot = zero, right = zero;
  for (size_t s = 0; s < c.links; ++s) {
    const uint32_t* at = c.points + (s + 1) * kLanes;
    gather_rows4(rows, at, q);
    const W tx = q[0] - p[0], ty = q[1] - p[1], tz = q[2] - p[2];
    W dx = tx, dy = ty, dz = tz;
    if (c.base) {
      const T* base = c.base + 3 * s * kLanes;
      dx += load(base), dy += load(base + kLanes), dz += load(base + 2 * kLanes);
    }
    const W l2 = madd(dx, dx, madd(dy, dy, dz * dz));
    const W per_l = where_positive(l2, one / sqrt(l2), zero);
    const W ux = dx * per_l, uy = dy * per_l, uz = dz * per_l, weight = p[3] + q[3];
    W a = load(c.compliance + s * kLanes) * per_h2, b = load(c.rest + s * kLanes) - l2 * per_l;
    if (c.lambda) b = nmadd(a, load(c.lambda + s * kLanes), b);
    if (c.damping) {
      gather_rows4(before, at, q_old);
      const W g = load(c.damping + s * kLanes) * W(per.h), share = one / (one + g);
      const W ex = tx - (q_old[0] - p_old[0]), ey = ty - (q_old[1] - p_old[1]),
              ez = tz - (q_old[2] - p_old[2]);
      b = nmadd(g, madd(ux, ex, madd(uy, ey, uz * ez)), b) * share;
      a *= share;
      for (int k = 0; k < 4; ++k) p_old[k] = q_old[k];
    }
    const W side = -(p[3] * madd(ux, nx, madd(uy, ny, uz * nz)));
    const W factor = side * pivot;
    pivot = where_positive(weight, one / nmadd(factor, side, madd(weight, regular, a)), zero);
    right = nmadd(factor, right, b);
    scratch[s] = {ux, uy, uz, per_l, pivot, side, right};
    nx = ux, ny = uy, nz = uz;
    for (int k = 0; k < 4; ++k) p[k] = q[k];
  }
  W l = zero, side = zero, px = zero, py = zero, pz = zero, pull_after = zero, most = zero;
  const W share(relax);
  for (size_t s = c.links; s-- > 0;) {
    const ChainRow<T>& row = scratch[s];
    const uint32_t* at = c.points + (s + 1) * kLanes;
    l = row.pivot * nmadd(side, l, row.right);
    side = row.side;
    W total = l;
    if (c.lambda) {
      total += load(c.lambda + s * kLanes);
      for (int i = 0; i < kLanes; ++i) c.lambda[s * kLanes + i] = total.v[i];
    }
    const W pull_before = -total * row.per_length;
    const W pull = l * share;
    const W x = pull * row.x, y = pull * row.y, z = pull * row.z;
    gather_rows4(rows, at, q);
    q[0] = madd(q[3], x - px, q[0]), q[1] = madd(q[3], y - py, q[1]), q[2] = madd(q[3], z - pz, q[2]);
    scatter_rows4(rows, at, q);
    most = max(most, q[3] * (pull_before + pull_after));
    pull_after = pull_before;
    px = x, py = y, pz = z;
  }
  gather_rows4(rows, c.points, p);
  p[0] = nmadd(p[3], px, p[0]), p[1] = nmadd(p[3], py, p[1]), p[2] = nmadd(p[3], pz, p[2]);
  scatter_rows4(rows, c.points, p);
  most = max(most, p[3] * pull_after);
  T q_most = 0;
  for (int i = 0; i < kLanes; ++i) q_most = most.v[i] > q_most ? most.v[i] : q_most;
  return q_most;
}

}  // namespace truestep::xpbd
