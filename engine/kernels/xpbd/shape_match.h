// Shape matching (Mueller, Heidelberger, Teschner, Gross 2005, "Meshless deformations based on shape
// matching", sections 3 and 4.2): goals g_i = c + T q_i of points with rest positions q_i relative to their
// centre of mass. With A_pq = sum m (x - c) q^T and A_qq = sum m q q^T
//   T = (1 - beta) R + beta A / det(A)^(1/3),   A = A_pq A_qq^-1,
// where R is the rotation of the polar decomposition of A_pq. Both parts keep the centre and exert no moment,
// as R^T A_pq and A A_qq A^T are symmetric, so moving all points by the same share of the way to their goals
// conserves both momenta.
#pragma once
#include <algorithm>

#include "engine/math/svd3.h"
#include "engine/math/trig.h"

namespace truestep::xpbd {

/// `inverse`: A_qq^-1; zero if the points lie in a plane: they are then only rotated.
inline Mat3 match_transform(const Mat3& apq, const Mat3& inverse, double beta) {
  const Svd3 d = svd3(apq);
  const Mat3 turn = d.u * transposed(d.v);
  if (!(beta > 0)) return turn;
  const Mat3 a = apq * inverse;
  // An inverted or nearly flat body has no volume to preserve: below half of it, goals turn rigid gradually.
  constexpr double kRigid = 0.2, kFree = 0.5;
  const double det = determinant(a);
  if (!(det > kRigid)) return turn;
  const double share = beta * std::min(1.0, (det - kRigid) / (kFree - kRigid));
  return (1 - share) * turn + (share / trig::pow(det, 1.0 / 3)) * a;
}

/// A^-1 of a symmetric positive matrix; zero where it is singular.
inline Mat3 inverse_or_zero(const Mat3& a) {
  constexpr double kSingular = 1e-9;
  const double det = determinant(a), size = trace(a) / 3;
  if (!(det > kSingular * size * size * size)) return {};
  return (1 / det) * transposed(cofactor(a));
}

/// Softness s (1/kg) of a point of `mass` m, 1 / (m omega2 h^2): moving it by the share w / (w + s) of the
/// way to its goal, w in 1/kg, is an implicit Euler step of h (s) of a spring of squared frequency omega2
/// (1/s^2).
inline double match_softness(double omega2, double mass, double h) {
  return 1 / (omega2 * mass * h * h);
}

}  // namespace truestep::xpbd
