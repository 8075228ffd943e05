// Thermostats as factors on velocities. N_f degrees of freedom, kinetic energy K, target kT.
//   velocity rescaling   K follows the canonical distribution with relaxation time tau
//                        (Bussi, Donadio, Parrinello 2007, eq. A7, exact for any step)
//   Nose-Hoover chain    Q_1 = N_f kT tau^2, Q_j = kT tau^2 (Martyna, Tuckerman, Tobias, Klein 1996, eqs. 29,
//                        31), half a step before and after the atoms' own
#pragma once
#include <cmath>
#include <span>

#include "engine/kernels/molecular/normal.h"
#include "engine/math/trig.h"

namespace truestep::molecular {

/// Identifies a random number.
struct Draw {
  uint64_t seed, stream, step;
};

/// Factor on all velocities for a step with h / tau = `share`. K and kT in J; 1 when nothing moves.
inline double rescaling_factor(double kinetic, double freedoms, double kt, double share, const Draw& draw) {
  if (!(kinetic > 0)) return 1;
  const double c = trig::exp(-share), ratio = 0.5 * kt / kinetic;  // mean K over N_f K
  const uint64_t first = draw.step << 8;
  const double r = normal4(draw.seed, draw.stream, first)[0];
  const double others =
      freedoms > 1 ? squares_of_normals(freedoms - 1, draw.seed, draw.stream, first + 1) : 0;
  const double a2 = c + ratio * (1 - c) * (r * r + others) + 2 * r * std::sqrt(c * ratio * (1 - c));
  const double sign = r + std::sqrt(c / (ratio * (1 - c))) < 0 ? -1 : 1;
  return sign * std::sqrt(a2 > 0 ? a2 : 0);
}

/// Positions and velocities of the chain, as many as links.
struct Chain {
  std::span<double> xi, v;
};
struct ChainSetting {
  double freedoms, kt, tau;
  double mass(size_t j) const { return (j == 0 ? freedoms : 1) * kt * tau * tau; }
};

/// Advances the chain by h / 2; returns the factor on all velocities.
inline double chain_half_step(Chain c, const ChainSetting& s, double kinetic, double h) {
  const size_t n = c.xi.size();
  const auto pull = [&](size_t j, double twice_k) {
    const double drive =
        j == 0 ? twice_k - s.freedoms * s.kt : s.mass(j - 1) * c.v[j - 1] * c.v[j - 1] - s.kt;
    return drive / s.mass(j);
  };
  const auto turn = [&](size_t j, double twice_k) {
    const double drag = j + 1 < n ? trig::exp(-0.125 * h * c.v[j + 1]) : 1;
    c.v[j] = (c.v[j] * drag + 0.25 * h * pull(j, twice_k)) * drag;
  };
  for (size_t j = n; j-- > 0;) turn(j, 2 * kinetic);
  const double factor = trig::exp(-0.5 * h * c.v[0]);
  for (size_t j = 0; j < n; ++j) c.xi[j] += 0.5 * h * c.v[j];
  for (size_t j = 0; j < n; ++j) turn(j, 2 * kinetic * factor * factor);
  return factor;
}

/// The chain's contribution to the conserved energy, J.
inline double chain_energy(std::span<const double> xi, std::span<const double> v, const ChainSetting& s) {
  double sum = 0;
  for (size_t j = 0; j < xi.size(); ++j) {
    sum += 0.5 * s.mass(j) * v[j] * v[j] + (j == 0 ? s.freedoms : 1) * s.kt * xi[j];
  }
  return sum;
}

/// Change of ln V over h: stochastic cell rescaling (Bernetti, Bussi 2020, eq. 5), with `rate` = beta / tau
/// (1/(Pa s)), pressures in Pa, the volume in m^3, a normal number r. If the pressure is far off, the volume
/// changes by at most 2 % at once.
inline double cell_rescaling(double pressure, double target, double volume, double kt, double rate, double h,
                             double r) {
  constexpr double kMost = 0.02;
  const double towards = rate * (pressure - target) * h;
  return std::fmin(kMost, std::fmax(-kMost, towards)) + std::sqrt(2 * kt * rate * h / volume) * r;
}

}  // namespace truestep::molecular
