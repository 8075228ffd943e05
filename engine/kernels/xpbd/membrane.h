// A triangle of a sheet of volume V (area times thickness) as constraints on its strain. With edges e1, e2
// from the first point and B the inverse of their rest matrix, F = (e1, e2) B is 3 x 2 with columns f1 and
// f2.
//   st_venant_kirchhoff: E11 = (f1.f1 - 1) / 2, E22 = (f2.f2 - 1) / 2, g = f1.f2 (all 1), three constraints
//     solved at once with the inverse of plane stress as compliance,
//       1 / (E V) ((1, -nu, 0), (-nu, 1, 0), (0, 0, 2 (1 + nu)))
//     (Macklin, Mueller, Chentanez 2016, "XPBD", section 5.2); without compliance they are the strain-based
//     constraints of position-based dynamics (Mueller, Chentanez, Kim, Macklin 2014, "Strain based dynamics",
//     section 4, with Green strain instead of stretch, solved at once instead of one by one).
//   neo_hookean: C_D = sqrt(tr F^T F), C_H = J - 1 - r, J = |f1 x f2|, alpha_D = 1 / (mu V),
//     alpha_H = r alpha_D (neo_hookean.h in two dimensions: energy
//       V (mu/2 (tr F^T F - 2) + l/2 ((J - 1 - r)^2 - r^2)),   r = mu / l = (1 - nu) / (1 + nu),
//     which is plane stress at small strain). A triangle of zero area has no normal and stays on its line.
// Both return q, h^2 times stress times the curvature of the strains, as chain.h does for a link's tension.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/kernels/xpbd/compliance.h"
#include "engine/math/vec3.h"
#include "engine/math/wide_rows.h"

namespace truestep::xpbd {

/// A material's strain energy per volume (Pa) over Young's modulus, from F.
inline double st_venant_kirchhoff_membrane(const Vec3& f1, const Vec3& f2, double nu) {
  const double a = 0.5 * (norm2(f1) - 1), b = 0.5 * (norm2(f2) - 1), g = dot(f1, f2);
  return 0.5 / (1 - nu * nu) * (a * a + b * b + 2 * nu * a * b + 0.5 * (1 - nu) * g * g);
}
inline double neo_hookean_membrane(const Vec3& f1, const Vec3& f2, double nu) {
  const double mu = 0.5 / (1 + nu), r = (1 - nu) / (1 + nu), c = norm(cross(f1, f2)) - 1 - r;
  return 0.5 * mu * (norm2(f1) + norm2(f2) - 2) + 0.5 * mu / r * (c * c - r * r);
}

/// One triangle per lane, no points shared.
template <class T>
struct MembraneSet {
  const uint32_t* points = nullptr;  ///< 3 x lanes
  const T* inverse = nullptr;        ///< 4 x lanes: B, row by row, 1/m
  const T* compliance = nullptr;     ///< lanes: 1 / (E V); 0: rigid (st_venant_kirchhoff alone)
  T poisson_ratio = 0;
  T* lambda = nullptr;      ///< 3 x lanes (neo_hookean: 2), added to; null: zero so far, not needed later
  const T* base = nullptr;  ///< 6 x lanes: x1 - x0, x2 - x0 where rows are 0
};

namespace membrane {

template <class T>
struct Lanes {
  using W = Wide<T>;
  static constexpr int kLanes = W::kLanes;
  W x[3][4], e[2][3], b[2][2], f[2][3];

  static W load(const T* p) {
    W r;
    for (int i = 0; i < kLanes; ++i) r.v[i] = p[i];
    return r;
  }
  Lanes(const MembraneSet<T>& c, const T* rows) {
    for (int i = 0; i < 3; ++i) gather_rows4(rows, c.points + i * kLanes, x[i]);
    for (int k = 0; k < 2; ++k) {
      for (int r = 0; r < 3; ++r) e[k][r] = x[k + 1][r] - x[0][r] + load(c.base + (3 * k + r) * kLanes);
      for (int m = 0; m < 2; ++m) b[k][m] = load(c.inverse + (2 * k + m) * kLanes);
    }
    for (int m = 0; m < 2; ++m) {
      for (int r = 0; r < 3; ++r) f[m][r] = madd(e[0][r], b[0][m], e[1][r] * b[1][m]);
    }
  }
  static W dot(const W* p, const W* q) { return madd(p[0], q[0], madd(p[1], q[1], p[2] * q[2])); }
  /// The third gradient is minus the sum of the others, which are g[1] and g[2].
  static void close(W g[3][3]) {
    for (int r = 0; r < 3; ++r) g[0][r] = -(g[1][r] + g[2][r]);
  }
  W product(const W g[3][3], const W k[3][3]) const {
    W s = W::zero();
    for (int i = 0; i < 3; ++i) s = madd(x[i][3], dot(g[i], k[i]), s);
    return s;
  }
  /// sum_i w_i b_im b_in, from which curvatures of E and |F|^2 follow.
  W spread(int m, int n) const {
    const W zero = b[0][m] + b[1][m], other = b[0][n] + b[1][n];
    return madd(x[0][3], zero * other, madd(x[1][3], b[0][m] * b[0][n], x[2][3] * b[1][m] * b[1][n]));
  }
  void move(const W g[3][3], const W& by) {
    for (int i = 0; i < 3; ++i) {
      for (int r = 0; r < 3; ++r) x[i][r] = madd(x[i][3] * by, g[i][r], x[i][r]);
    }
  }
  void store(const MembraneSet<T>& c, T* rows) const {
    for (int i = 0; i < 3; ++i) scatter_rows4(rows, c.points + i * kLanes, x[i]);
  }
};

template <class T>
T largest(const Wide<T>& a) {
  T most = 0;
  for (int i = 0; i < Wide<T>::kLanes; ++i) most = std::max(most, std::abs(a.v[i]));
  return most;
}

}  // namespace membrane

/// Moves the points and returns q of the worst lane.
template <class T>
T solve_st_venant_kirchhoff(const MembraneSet<T>& c, const PerStep<T>& per, T relax, T* rows) {
  using W = Wide<T>;
  using L = membrane::Lanes<T>;
  constexpr int kLanes = W::kLanes;
  L t(c, rows);
  const W half(T(0.5)), one(T(1)), nu(c.poisson_ratio);
  W g[3][3][3];  // gradients of E11, E22 and g by the points
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 2; ++k) {
      g[0][k + 1][r] = t.f[0][r] * t.b[k][0], g[1][k + 1][r] = t.f[1][r] * t.b[k][1];
      g[2][k + 1][r] = madd(t.f[0][r], t.b[k][1], t.f[1][r] * t.b[k][0]);
    }
  }
  for (auto& of : g) L::close(of);
  W a[3][3], right[3] = {half * (one - L::dot(t.f[0], t.f[0])), half * (one - L::dot(t.f[1], t.f[1])),
                         -L::dot(t.f[0], t.f[1])};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) a[i][j] = t.product(g[i], g[j]);
  }
  const W soft = L::load(c.compliance) * W(per.h2), across = soft * W(T(2)) * (one + nu);
  if (c.lambda) {
    const W l0 = L::load(c.lambda), l1 = L::load(c.lambda + kLanes), l2 = L::load(c.lambda + 2 * kLanes);
    right[0] = nmadd(soft, nmadd(nu, l1, l0), right[0]), right[1] = nmadd(soft, nmadd(nu, l0, l1), right[1]);
    right[2] = nmadd(across, l2, right[2]);
  }
  // A triangle with one free point can satisfy only two strains: a share of the trace keeps the third
  // solvable.
  const W trace = (a[0][0] + a[1][1] + a[2][2]) * W(T(1e-9));
  a[0][0] += soft + trace, a[1][1] += soft + trace, a[2][2] += across + trace;
  a[1][0] = nmadd(soft, nu, a[1][0]);
  const auto over = [&](const W& p, const W& q) { return where_positive(q, p / q, W::zero()); };
  const W l10 = over(a[1][0], a[0][0]), l20 = over(a[2][0], a[0][0]);
  const W d1 = nmadd(l10, a[1][0], a[1][1]), m = nmadd(l20, a[1][0], a[2][1]), l21 = over(m, d1);
  const W d2 = nmadd(l21, m, nmadd(l20, a[2][0], a[2][2]));
  const W y1 = nmadd(l10, right[0], right[1]), y2 = nmadd(l21, y1, nmadd(l20, right[0], right[2]));
  W step[3];
  step[2] = over(y2, d2), step[1] = nmadd(l21, step[2], over(y1, d1));
  step[0] = nmadd(l10, step[1], nmadd(l20, step[2], over(right[0], a[0][0])));
  W total[3] = {step[0], step[1], step[2]};
  if (c.lambda) {
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < kLanes; ++i) c.lambda[k * kLanes + i] += step[k].v[i];
      total[k] = L::load(c.lambda + k * kLanes);
    }
  }
  for (int k = 0; k < 3; ++k) t.move(g[k], step[k] * W(relax));
  t.store(c, rows);
  const auto size = [](W v) {
    for (int i = 0; i < kLanes; ++i) v.v[i] = std::abs(v.v[i]);
    return v;
  };
  const W along = t.spread(0, 0), over_it = t.spread(1, 1);
  return membrane::largest<T>(madd(size(total[0]), along, size(total[1]) * over_it) +
                              size(total[2]) * (along + over_it));
}

template <class T>
T solve_neo_hookean_membrane(const MembraneSet<T>& c, const PerStep<T>& per, T* rows) {
  using W = Wide<T>;
  using L = membrane::Lanes<T>;
  constexpr int kLanes = W::kLanes;
  L t(c, rows);
  const W one(T(1));
  const T nu = c.poisson_ratio, r = (1 - nu) / (1 + nu);
  const W i1 = L::dot(t.f[0], t.f[0]) + L::dot(t.f[1], t.f[1]), size = sqrt(i1);
  const W per_size = where_positive(i1, one / size, W::zero());
  const auto crossed = [](const W* p, const W* q, const W& by, W* out) {
    out[0] = (p[1] * q[2] - p[2] * q[1]) * by, out[1] = (p[2] * q[0] - p[0] * q[2]) * by;
    out[2] = (p[0] * q[1] - p[1] * q[0]) * by;
  };
  W n[3], d[3][3], g[3][3];
  crossed(t.f[0], t.f[1], one, n);
  const W j2 = L::dot(n, n), j = sqrt(j2), per_j = where_positive(j2, one / j, W::zero());
  for (W& part : n) part *= per_j;
  // dJ/de1 = e2 x n det B, dJ/de2 = n x e1 det B, n along f1 x f2 = e1 x e2 det B.
  const W det = t.b[0][0] * t.b[1][1] - t.b[0][1] * t.b[1][0];
  crossed(t.e[1], n, det, g[1]), crossed(n, t.e[0], det, g[2]);
  for (int k = 0; k < 2; ++k) {
    for (int a = 0; a < 3; ++a) {
      d[k + 1][a] = madd(t.f[0][a], t.b[k][0], t.f[1][a] * t.b[k][1]) * per_size;
    }
  }
  L::close(d), L::close(g);
  const W soft = L::load(c.compliance) * W(2 * (1 + nu) * per.h2), soft_g = soft * W(r);
  W dd = t.product(d, d) + soft, gg = t.product(g, g) + soft_g;
  const W dg = t.product(d, g);
  W right_d = -size, right_g = W(1 + r) - j;
  if (c.lambda) {
    right_d = nmadd(soft, L::load(c.lambda), right_d);
    right_g = nmadd(soft_g, L::load(c.lambda + kLanes), right_g);
  }
  const W det_a = nmadd(dg, dg, dd * gg), per_det = where_positive(det_a, one / det_a, W::zero());
  const W step_d = nmadd(dg, right_g, gg * right_d) * per_det;
  const W step_g = nmadd(dg, right_d, dd * right_g) * per_det;
  W total = step_d;
  if (c.lambda) {
    for (int i = 0; i < kLanes; ++i) c.lambda[i] += step_d.v[i], c.lambda[kLanes + i] += step_g.v[i];
    total = L::load(c.lambda);
  }
  t.move(d, step_d), t.move(g, step_g);
  t.store(c, rows);
  return membrane::largest<T>(total * per_size * (t.spread(0, 0) + t.spread(1, 1)));
}

}  // namespace truestep::xpbd
