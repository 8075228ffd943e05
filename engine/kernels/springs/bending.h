// Bending of two adjacent links: points x0, x1, x2, links a = x1 - x0 and b = x2 - x1, angle theta between
// them,
//   E = 1/2 B |k|^2,   k = 2 (a x b) / (|a| |b| + a . b),   |k| = 2 tan(theta / 2)
// (Bergou, Wardetzky, Robinson, Audoly, Grinspun 2008, "Discrete Elastic Rods", eq. 1 and section 4.2.2), for
// a rod that is straight at rest. With r = cos theta the energy is E = 4 B / (1 + r) - 2 B, from which all
// derivatives here are taken, including those for links of changing length. B = EI / l for a rod of flexural
// stiffness EI (N m^2) with links of length l (m); D w / l for a strip of width w of a plate of flexural
// rigidity D (N m). Links folded back on each other (r = -1) have infinite energy: in derivatives r is taken
// as at least kLeast - 1. Links of zero length have no direction and exert no force.
#pragma once
#include <array>
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep::bending {

inline constexpr double kLeast = 1e-6;

/// Directions of the links, 1 / |a| and 1 / |b|, and r; all 0 if a link has zero length.
struct Links {
  Vec3 a, b;
  double per_a = 0, per_b = 0, r = 1;
};
inline Links links(const Vec3& x0, const Vec3& x1, const Vec3& x2) {
  const Vec3 a = x1 - x0, b = x2 - x1;
  const double la = norm(a), lb = norm(b);
  if (!(la > 0) || !(lb > 0)) return {};
  Links out{a / la, b / lb, 1 / la, 1 / lb};
  out.r = std::fmax(dot(out.a, out.b), kLeast - 1);
  return out;
}

/// Energy in J for B in J.
inline double energy(const Links& l, double B) {
  return 2 * B * (1 - l.r) / (1 + l.r);
}

/// dE/dr and d2E/dr2.
inline double slope(const Links& l, double B) {
  return -4 * B / ((1 + l.r) * (1 + l.r));
}
inline double curvature(const Links& l, double B) {
  return 8 * B / ((1 + l.r) * (1 + l.r) * (1 + l.r));
}

/// Forces on the three points in N.
inline std::array<Vec3, 3> forces(const Links& l, double B) {
  const double s = slope(l, B);
  const Vec3 ga = (l.b - l.a * l.r) * (s * l.per_a), gb = (l.a - l.b * l.r) * (s * l.per_b);
  return {ga, gb - ga, -gb};
}

/// Second derivatives of E with respect to (a, a), (a, b) and (b, b) in N/m, row by row.
struct Hessian {
  double aa[9] = {}, ab[9] = {}, bb[9] = {};
};

namespace detail {
/// m += f x y^T
inline void add_outer(double* m, double f, const Vec3& x, const Vec3& y) {
  const double u[3] = {x.x, x.y, x.z}, v[3] = {y.x, y.y, y.z};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m[3 * i + j] += f * u[i] * v[j];
  }
}
/// m += f (I - x x^T)
inline void add_projector(double* m, double f, const Vec3& x) {
  m[0] += f, m[4] += f, m[8] += f;
  add_outer(m, -f, x, x);
}
/// m += f (I - x x^T)(I - y y^T)
inline void add_projectors(double* m, double f, const Vec3& x, const Vec3& y) {
  m[0] += f, m[4] += f, m[8] += f;
  add_outer(m, -f, x, x), add_outer(m, -f, y, y);
  add_outer(m, f * dot(x, y), x, y);
}
}  // namespace detail

inline Hessian hessian(const Links& l, double B) {
  using namespace detail;
  const double s = slope(l, B), c = curvature(l, B);
  const Vec3 u = (l.b - l.a * l.r) * l.per_a, w = (l.a - l.b * l.r) * l.per_b;
  Hessian h;
  add_outer(h.aa, c, u, u), add_outer(h.ab, c, u, w), add_outer(h.bb, c, w, w);
  add_outer(h.aa, -s * l.per_a, u, l.a), add_outer(h.aa, -s * l.per_a, l.a, u);
  add_outer(h.bb, -s * l.per_b, w, l.b), add_outer(h.bb, -s * l.per_b, l.b, w);
  add_projector(h.aa, -s * l.r * l.per_a * l.per_a, l.a);
  add_projector(h.bb, -s * l.r * l.per_b * l.per_b, l.b);
  add_projectors(h.ab, s * l.per_a * l.per_b, l.a, l.b);
  return h;
}

/// The Hessian without the term from the second derivatives of the links' directions: -dE/dr J^T J with J the
/// derivative of b / |b| - a / |a|. Positive semidefinite, and equal to the exact one where the links are in
/// line.
inline Hessian definite_hessian(const Links& l, double B) {
  using namespace detail;
  const double s = slope(l, B);
  Hessian h;
  add_projector(h.aa, -s * l.per_a * l.per_a, l.a);
  add_projector(h.bb, -s * l.per_b * l.per_b, l.b);
  add_projectors(h.ab, s * l.per_a * l.per_b, l.a, l.b);
  return h;
}

/// Block (i, j) of -d2E / dx_i dx_j for the points 0, 1, 2, row by row: a contribution to df/dx.
inline std::array<double, 9> force_slope(const Hessian& h, int i, int j) {
  // dx0 changes a by -1; dx1 changes a by 1 and b by -1; dx2 changes b by 1.
  constexpr double kA[3] = {-1, 1, 0}, kB[3] = {0, -1, 1};
  std::array<double, 9> out;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      const int k = 3 * r + c, t = 3 * c + r;
      out[static_cast<size_t>(k)] = -(kA[i] * kA[j] * h.aa[k] + kA[i] * kB[j] * h.ab[k] +
                                      kB[i] * kA[j] * h.ab[t] + kB[i] * kB[j] * h.bb[k]);
    }
  }
  return out;
}

}  // namespace truestep::bending
