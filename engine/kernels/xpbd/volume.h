// Volume of a tetrahedron as a constraint (Mueller, Heidelberger, Hennix, Ratcliff 2007, "Position based
// dynamics", section 4.4, with the factor 1/6):
//   C = 1/6 (x1 - x0) . ((x2 - x0) x (x3 - x0)) - V,   E = 1/2 C^2 / alpha,   alpha = V / K,
// with the bulk modulus K (Pa). An inverted tetrahedron has a negative volume and is pushed back through
// itself.
#pragma once
#include "engine/kernels/xpbd/compliance.h"
#include "engine/math/vec3.h"
#include "engine/math/wide_rows.h"

namespace truestep::xpbd {

/// m^3, positive if x3 is on the side of (x1 - x0) x (x2 - x0).
inline double volume(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3) {
  return dot(x1 - x0, cross(x2 - x0, x3 - x0)) / 6;
}

/// One tetrahedron per lane, no points shared.
template <class T>
struct VolumeSet {
  const uint32_t* points = nullptr;  ///< 4 x lanes
  const T* rest = nullptr;           ///< lanes, m^3
  const T* compliance = nullptr;     ///< lanes
  T* lambda = nullptr;               ///< lanes, added to; null: zero so far, and not needed later
  const T* base = nullptr;           ///< 9 x lanes: x1 - x0, x2 - x0, x3 - x0 where rows are 0; null: 0
};

template <class T>
void solve_volumes(const VolumeSet<T>& c, const PerStep<T>& per, T relax, T* rows) {
  using W = Wide<T>;
  struct W3 {
    W x, y, z;
  };
  constexpr int kLanes = W::kLanes;
  const auto load = [](const T* p) {
    W r;
    for (int i = 0; i < kLanes; ++i) r.v[i] = p[i];
    return r;
  };
  const auto edge = [&](const W* a, const W* b, int k) {
    W3 e{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    if (!c.base) return e;
    const T* base = c.base + 3 * k * kLanes;
    e.x += load(base), e.y += load(base + kLanes), e.z += load(base + 2 * kLanes);
    return e;
  };
  const W sixth(T(1) / 6);
  const auto sixth_of_cross = [&](const W3& a, const W3& b) {
    return W3{(a.y * b.z - a.z * b.y) * sixth, (a.z * b.x - a.x * b.z) * sixth,
              (a.x * b.y - a.y * b.x) * sixth};
  };
  W x[4][4];
  for (int i = 0; i < 4; ++i) gather_rows4(rows, c.points + i * kLanes, x[i]);
  const W3 e1 = edge(x[1], x[0], 0), e2 = edge(x[2], x[0], 1), e3 = edge(x[3], x[0], 2);
  W3 g[4];
  g[1] = sixth_of_cross(e2, e3), g[2] = sixth_of_cross(e3, e1), g[3] = sixth_of_cross(e1, e2);
  g[0] = {-(g[1].x + g[2].x + g[3].x), -(g[1].y + g[2].y + g[3].y), -(g[1].z + g[2].z + g[3].z)};
  W weight = W::zero();
  for (int i = 0; i < 4; ++i) {
    weight = madd(x[i][3], madd(g[i].x, g[i].x, madd(g[i].y, g[i].y, g[i].z * g[i].z)), weight);
  }
  const W alpha = load(c.compliance) * W(per.h2);
  W b = load(c.rest) - madd(e1.x, g[1].x, madd(e1.y, g[1].y, e1.z * g[1].z));
  if (c.lambda) b = nmadd(alpha, load(c.lambda), b);
  W step = where_positive(weight, b / (weight + alpha), W::zero());
  if (c.lambda) {
    for (int i = 0; i < kLanes; ++i) c.lambda[i] += step.v[i];
  }
  step *= W(relax);
  for (int i = 0; i < 4; ++i) {
    const W s = x[i][3] * step;
    x[i][0] = madd(s, g[i].x, x[i][0]), x[i][1] = madd(s, g[i].y, x[i][1]),
    x[i][2] = madd(s, g[i].z, x[i][2]);
    scatter_rows4(rows, c.points + i * kLanes, x[i]);
  }
}

}  // namespace truestep::xpbd
