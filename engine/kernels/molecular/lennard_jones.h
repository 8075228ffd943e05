// The Lennard-Jones potential between two atoms, and its truncation at the cut-off:
//   U(r) = 4 eps ((sigma/r)^12 - (sigma/r)^6) = c12 / r^12 - c6 / r^6
// truncated: U for r < rc; shifted: U - U(rc); switched: U S with S falling from 1 at rs to 0 at rc,
//   S = (rc^2 - r^2)^2 (rc^2 + 2 r^2 - 3 rs^2) / (rc^2 - rs^2)^3     (Brooks et al. 1983, CHARMM, eq. 10)
// Kinds are mixed by the Lorentz-Berthelot rules: sigma = (sigma_a + sigma_b) / 2, eps = sqrt(eps_a eps_b).
// The tail is the contribution from beyond rc, assuming a uniform fluid there (Allen, Tildesley 1987, eqs.
// 2.137, 2.138).
#pragma once
#include <cmath>

namespace truestep::molecular {

enum class Truncation : unsigned char { truncated, shifted, switched };

/// c12 in J m^12, c6 in J m^6, shift in J: U(rc) of a shifted potential, else 0.
struct LjPair {
  double c12 = 0, c6 = 0, shift = 0;
};

inline LjPair mix_lorentz_berthelot(double sigma_a, double epsilon_a, double sigma_b, double epsilon_b) {
  const double sigma = 0.5 * (sigma_a + sigma_b), epsilon = std::sqrt(epsilon_a * epsilon_b);
  const double s2 = sigma * sigma, s6 = s2 * s2 * s2;
  return {4 * epsilon * s6 * s6, 4 * epsilon * s6, 0};
}

/// U at a squared distance (m^2), without cut-off or shift, J.
inline double lj_potential(const LjPair& p, double r2) {
  const double i2 = 1 / r2, i6 = i2 * i2 * i2;
  return i6 * (p.c12 * i6 - p.c6);
}
/// Force over distance, N/m: the force on i is this times x_i - x_j.
inline double lj_force_over_r(const LjPair& p, double r2) {
  const double i2 = 1 / r2, i6 = i2 * i2 * i2;
  return i6 * i2 * (12 * p.c12 * i6 - 6 * p.c6);
}

/// S and dS/d(r^2) (1/m^2) between the squared lengths from2 = rs^2 and to2 = rc^2.
struct Switch {
  double value, slope;
};
inline Switch lj_switch(double r2, double from2, double to2) {
  if (r2 <= from2) return {1, 0};
  if (r2 >= to2) return {0, 0};
  const double gap = to2 - from2, scale = 1 / (gap * gap * gap), left = to2 - r2;
  return {left * left * (to2 + 2 * r2 - 3 * from2) * scale, 6 * left * (from2 - r2) * scale};
}

/// Integrals from rc to infinity of r^2 U (J m^3) and of r^3 dU/dr (J m^3), for the tails of energy and
/// pressure.
struct LjTail {
  double energy, virial;
};
inline LjTail lj_tail(const LjPair& p, double rc) {
  const double i3 = 1 / (rc * rc * rc), i9 = i3 * i3 * i3;
  return {p.c12 * i9 / 9 - p.c6 * i3 / 3, -12 * p.c12 * i9 / 9 + 6 * p.c6 * i3 / 3};
}

}  // namespace truestep::molecular
