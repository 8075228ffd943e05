// Weights of Chebyshev's semi-iterative method for x_{k+1} = B x_k + c with eigenvalues of B within [-rho,
// rho] (Golub, Varga 1961; Wang 2015, "A Chebyshev semi-iterative approach for accelerating projective and
// position-based dynamics", eq. 4):
//   x_{k+1} = omega_{k+1} (J(x_k) - x_{k-1}) + x_{k-1},
//   omega_1 = 1,   omega_2 = 2 / (2 - rho^2),   omega_{k+1} = 4 / (4 - rho^2 omega_k).
#pragma once

namespace truestep {

/// omega of iteration `k`, counted from 0, after `before`.
inline double chebyshev_weight(int k, double rho, double before) {
  if (k == 0) return 1;
  return k == 1 ? 2 / (2 - rho * rho) : 4 / (4 - rho * rho * before);
}

/// rho for n iterations that take all that B does within [-rho, rho] down to a tenth: T_n(1 / rho) =
/// 10, that is rho = 1 / cosh(acosh(10) / n). What is slower still is carried as far as n iterations reach
/// anyway.
inline double chebyshev_radius(int n) {
  constexpr double kAcosh10 = 2.993222846126381;
  const double z2 = kAcosh10 * kAcosh10 / (static_cast<double>(n) * n);
  // Taylor's polynomial of cosh, which is too small by 2e-3 at n = 1 and by 1e-12 from n = 6 on.
  const double cosh = 1 + z2 / 2 * (1 + z2 / 12 * (1 + z2 / 30 * (1 + z2 / 56)));
  // Constraints turn as iterations go on, and what larger weights make of that grows.
  constexpr double kMost = 0.999;
  return cosh > 1 / kMost ? 1 / cosh : kMost;
}

}  // namespace truestep
