// A tetrahedron of stable neo-Hookean material as two constraints (Macklin, Mueller 2021, "A constraint-based
// formulation of stable neo-Hookean materials", equations 8 to 18):
//   C_D = sqrt(tr F^T F),         alpha_D = 1 / (mu V),
//   C_H = det F - 1 - mu / l,     alpha_H = 1 / (l V),    l = lambda + mu,
// with energy V (mu/2 (tr F^T F - 3) + l/2 ((det F - 1 - mu/l)^2 - (mu/l)^2)), whose Lame constants at rest
// are lambda and mu: mu / l = 1 - 2 nu. Both are solved together, two equations for two multipliers: at rest
// they balance, whereas solving one after the other would disturb the points. There is no pole: an inverted
// tetrahedron recovers.
#pragma once
#include "engine/kernels/xpbd/compliance.h"
#include "engine/math/mat3.h"
#include "engine/math/wide_rows.h"

namespace truestep::xpbd {

/// J of a tetrahedron of volume V (m^3).
inline double neo_hookean_energy(const Mat3& f, double volume, double mu, double ratio) {
  const double l = mu / ratio, c = determinant(f) - 1 - ratio;
  return volume * (0.5 * mu * (inner(f, f) - 3) + 0.5 * l * (c * c - ratio * ratio));
}

/// One tetrahedron per lane, no points shared.
template <class T>
struct NeoHookeanSet {
  const uint32_t* points = nullptr;  ///< 4 x lanes
  const T* inverse = nullptr;     ///< 9 x lanes: inverse of (x1 - x0, x2 - x0, x3 - x0) as columns, at rest
  const T* compliance = nullptr;  ///< lanes: alpha_D
  T ratio = 1;                    ///< mu / l
  T* lambda = nullptr;            ///< 2 x lanes, added to; null: zero so far, and not needed later
  const T* base = nullptr;        ///< 9 x lanes: x1 - x0, x2 - x0, x3 - x0 where rows are 0
};

template <class T>
void solve_neo_hookean(const NeoHookeanSet<T>& c, const PerStep<T>& per, T* rows) {
  using W = Wide<T>;
  constexpr int kLanes = W::kLanes;
  const auto load = [](const T* p) {
    W r;
    for (int i = 0; i < kLanes; ++i) r.v[i] = p[i];
    return r;
  };
  W x[4][4], e[3][3], b[3][3], f[3][3];
  for (int i = 0; i < 4; ++i) gather_rows4(rows, c.points + i * kLanes, x[i]);
  for (int k = 0; k < 3; ++k) {
    for (int r = 0; r < 3; ++r) e[k][r] = x[k + 1][r] - x[0][r] + load(c.base + (3 * k + r) * kLanes);
    for (int m = 0; m < 3; ++m) b[k][m] = load(c.inverse + (3 * k + m) * kLanes);
  }
  W i1 = W::zero();
  for (int r = 0; r < 3; ++r) {
    for (int m = 0; m < 3; ++m) {
      f[r][m] = madd(e[0][r], b[0][m], madd(e[1][r], b[1][m], e[2][r] * b[2][m]));
      i1 = madd(f[r][m], f[r][m], i1);
    }
  }
  const W one(T(1)), size = sqrt(i1), per_size = where_positive(i1, one / size, W::zero());
  const auto crossed = [](const W* p, const W* q, const W& scale, W* out) {
    out[0] = (p[1] * q[2] - p[2] * q[1]) * scale, out[1] = (p[2] * q[0] - p[0] * q[2]) * scale;
    out[2] = (p[0] * q[1] - p[1] * q[0]) * scale;
  };
  W to[3];
  crossed(b[1], b[2], one, to);
  const W det_b = madd(b[0][0], to[0], madd(b[0][1], to[1], b[0][2] * to[2]));
  // Gradients by the four points: d of C_D, g of C_H.
  W d[4][3], g[4][3];
  crossed(e[1], e[2], det_b, g[1]), crossed(e[2], e[0], det_b, g[2]), crossed(e[0], e[1], det_b, g[3]);
  const W volume = madd(e[0][0], g[1][0], madd(e[0][1], g[1][1], e[0][2] * g[1][2]));
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k) {
      d[k + 1][r] = madd(f[r][0], b[k][0], madd(f[r][1], b[k][1], f[r][2] * b[k][2])) * per_size;
    }
    d[0][r] = -(d[1][r] + d[2][r] + d[3][r]), g[0][r] = -(g[1][r] + g[2][r] + g[3][r]);
  }
  W dd = W::zero(), dg = W::zero(), gg = W::zero();
  for (int i = 0; i < 4; ++i) {
    const W &w = x[i][3], *p = d[i], *q = g[i];
    dd = madd(w, madd(p[0], p[0], madd(p[1], p[1], p[2] * p[2])), dd);
    dg = madd(w, madd(p[0], q[0], madd(p[1], q[1], p[2] * q[2])), dg);
    gg = madd(w, madd(q[0], q[0], madd(q[1], q[1], q[2] * q[2])), gg);
  }
  const W ratio(c.ratio), soft = load(c.compliance) * W(per.h2), soft_g = soft * ratio;
  W right_d = -size, right_g = one + ratio - volume;
  if (c.lambda) {
    right_d = nmadd(soft, load(c.lambda), right_d);
    right_g = nmadd(soft_g, load(c.lambda + kLanes), right_g);
  }
  dd += soft, gg += soft_g;
  const W per_det = one / nmadd(dg, dg, dd * gg);
  const W step_d = nmadd(dg, right_g, gg * right_d) * per_det;
  const W step_g = nmadd(dg, right_d, dd * right_g) * per_det;
  if (c.lambda) {
    for (int i = 0; i < kLanes; ++i) c.lambda[i] += step_d.v[i], c.lambda[kLanes + i] += step_g.v[i];
  }
  for (int i = 0; i < 4; ++i) {
    for (int r = 0; r < 3; ++r) {
      x[i][r] = madd(x[i][3], madd(step_d, d[i][r], step_g * g[i][r]), x[i][r]);
    }
    scatter_rows4(rows, c.points + i * kLanes, x[i]);
  }
}

}  // namespace truestep::xpbd
