// Constraints that are linear in the positions of N points, C = sum_i K_i x_i (a vector, m), with energy
//   E = 1/2 |C|^2 / alpha.
// All three components share one denominator sum_i w_i K_i^2 + alpha~, and the step is exact. They model
// bending of
//   sheets: hinge of two triangles about the edge x0 x1 with the opposite corners x2, x3 and areas A0, A1,
//     isometric bending (Bergou, Wardetzky, Harmon, Zorin, Grinspun 2006, "A quadratic bending model for
//     inextensible surfaces", section 3): E = D / (2 (A0 + A1)) |sum K_i x_i|^2 with
//     K = (c03 + c04, c01 + c02, -c01 - c03, -c02 - c04), c the cotangents of the angles at the edge. The
//     weight is a third of the paper's: at its full weight a rolled sheet has three times a plate's D, on
//     equilateral and on right triangles. A third of it is Seung and Nelson's of 1988 (Phys. Rev. A 38, 1005)
//     on the former, isotropic, and between D / 2 and D on the latter: square grids use rods along their
//     sides and diagonals instead;
//   rods: |x0 - 2 x1 + x2|^2 EI / (2 l^3), that is 1/2 EI l k^2 with the curvature
//     k = |x0 - 2 x1 + x2| / l^2.
// Flat and straight at rest; rigid motions cost no energy. Stretching does, so these are valid for sheets and
// rods that hardly stretch.
#pragma once
#include <array>

#include "engine/kernels/xpbd/compliance.h"
#include "engine/math/vec3.h"
#include "engine/math/wide_rows.h"

namespace truestep::xpbd {

/// K of a hinge at rest, and A0 + A1 (m^2), which equals alpha times D (N m).
struct Hinge {
  std::array<double, 4> k;
  double area;
};
inline Hinge hinge(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3) {
  const auto cot = [](const Vec3& a, const Vec3& b) {
    const double s = norm(cross(a, b));
    return s > 0 ? dot(a, b) / s : 0;
  };
  const Vec3 e0 = x1 - x0, e1 = x2 - x0, e2 = x3 - x0, e3 = x2 - x1, e4 = x3 - x1;
  const double c01 = cot(e0, e1), c02 = cot(e0, e2), c03 = cot(-e0, e3), c04 = cot(-e0, e4);
  return {{c03 + c04, c01 + c02, -c01 - c03, -c02 - c04},
          0.5 * norm(cross(e0, e1)) + 0.5 * norm(cross(e0, e2))};
}

/// N points in every lane, none shared.
template <class T, int N>
struct LinearSet {
  const uint32_t* points = nullptr;  ///< N x lanes
  const T* k = nullptr;              ///< N x lanes
  const T* compliance = nullptr;     ///< lanes
  T* lambda = nullptr;               ///< 3 x lanes, added to; null: zero so far, and not needed later
  const T* base = nullptr;           ///< 3 x lanes: sum K_i x_i where rows are 0; null: 0
};

template <class T, int N>
void solve_linear(const LinearSet<T, N>& c, const PerStep<T>& per, T relax, T* rows) {
  using W = Wide<T>;
  constexpr int kLanes = W::kLanes;
  const auto load = [](const T* p) {
    W r;
    for (int i = 0; i < kLanes; ++i) r.v[i] = p[i];
    return r;
  };
  W x[N][4], k[N], sum[3] = {W::zero(), W::zero(), W::zero()}, weight = W::zero();
  for (int a = 0; c.base && a < 3; ++a) sum[a] = load(c.base + a * kLanes);
  for (int i = 0; i < N; ++i) {
    gather_rows4(rows, c.points + i * kLanes, x[i]);
    k[i] = load(c.k + i * kLanes);
    for (int a = 0; a < 3; ++a) sum[a] = madd(k[i], x[i][a], sum[a]);
    weight = madd(x[i][3] * k[i], k[i], weight);
  }
  const W alpha = load(c.compliance) * W(per.h2);
  const W inverse = where_positive(weight, W(T(1)) / (weight + alpha), W::zero());
  for (int a = 0; a < 3; ++a) {
    W b = -sum[a];
    if (c.lambda) b = nmadd(alpha, load(c.lambda + a * kLanes), b);
    W step = b * inverse;
    if (c.lambda) {
      for (int i = 0; i < kLanes; ++i) c.lambda[a * kLanes + i] += step.v[i];
    }
    step *= W(relax);
    for (int i = 0; i < N; ++i) x[i][a] = madd(x[i][3] * k[i], step, x[i][a]);
  }
  for (int i = 0; i < N; ++i) scatter_rows4(rows, c.points + i * kLanes, x[i]);
}

}  // namespace truestep::xpbd
