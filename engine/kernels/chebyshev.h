// Weights of Chebyshev's semi-iterative method for x_{k+1} = B x_k + c with the eigenvalues of B within
// [-rho, rho] (Golub, Varga 1961; Wang 2015, "A Chebyshev semi-iterative approach for accelerating projective
// and position-based dynamics", eq. 4):
//   x_{k+1} = omega_{k+1} (J(x_k) - x_{k-1}) + x_{k-1},
//   omega_1 = 1,   omega_2 = 2 / (2 - rho^2),   omega_{k+1} = 4 / (4 - rho^2 omega_k).
#pragma once

namespace truestep {

/// omega of iteration `k`, counted from 0; `before` is the previous one.
inline double chebyshev_weight(int k, double rho, double before) {
  if (k == 0) return 1;
  return k == 1 ? 2 / (2 - rho * rho) : 4 / (4 - rho * rho * before);
}

/// The rho for which n iterations reduce every component with an eigenvalue of B within [-rho, rho] to a
/// tenth: T_n(1 / rho) = 10, that is rho = 1 / cosh(acosh(10) / n). Slower components advance as far as n
/// iterations can take them in any case.
inline double chebyshev_radius(int n) {
  constexpr double kAcosh10 = 2.993222846126381;
  const double z2 = kAcosh10 * kAcosh10 / (static_cast<double>(n) * n);
  // Taylor polynomial of cosh, too small by 2e-3 at n = 1 and by 1e-12 from n = 6 on.
  const double cosh = 1 + z2 / 2 * (1 + z2 / 12 * (1 + z2 / 30 * (1 + z2 / 56)));
  // Constraint directions rotate during the iterations, and larger weights amplify the error this makes.
  constexpr double kMost = 0.999;
  return cosh > 1 / kMost ? 1 / cosh : kMost;
}

}  // namespace truestep
