// Central forces between two points, d = x_j - x_i, r = |d|, zero beyond a cutoff rc:
//   power law        f_i = S d / q^((n + 1) / 2),  q = r^2 + eps^2
//                    V = -S / ((n - 1) q^((n - 1) / 2))     (n = 1: S/2 log q)
//   soft repulsion   f_i = -k (rc - r) d / r                V = k/2 (rc - r)^2
//   viscosity        f_i = c (1 - r / rc)^2 (v_j - v_i)     (no potential)
// f_j = -f_i to the bit. V is shifted to 0 at rc; the power law's force is discontinuous there.
#pragma once
#include <cmath>
#include <cstdint>

#include "engine/math/trig.h"
#include "engine/math/vec3.h"

namespace truestep {

struct PairLaw {
  enum class Kind : uint8_t { power_law, soft_repulsion, viscosity } kind = Kind::power_law;
  double strength = 0;  ///< S (N m^n), k (N/m) or c (N s/m)
  double cutoff = 0;    ///< m
  double softening = 0;
  int exponent = 2;
};

/// Force (N) on i; w = v_j - v_i. r2 = |d|^2 must be below the square of the cutoff.
inline Vec3 pair_force(const PairLaw& law, const Vec3& d, const Vec3& w, double r2) {
  switch (law.kind) {
    case PairLaw::Kind::power_law: {
      const double q = r2 + law.softening * law.softening;
      if (!(q > 0)) return {};
      double p = law.exponent % 2 == 1 ? 1.0 : 1 / std::sqrt(q);
      for (int k = (law.exponent + 1) / 2; k > 0; --k) p /= q;
      return d * (law.strength * p);
    }
    case PairLaw::Kind::soft_repulsion: {
      const double r = std::sqrt(r2);
      return r > 0 ? d * (-law.strength * (law.cutoff - r) / r) : Vec3{};
    }
    case PairLaw::Kind::viscosity:
      break;
  }
  const double s = 1 - std::sqrt(r2) / law.cutoff;
  return w * (law.strength * s * s);
}

/// Potential energy (J) of the pair.
inline double pair_potential(const PairLaw& law, double r2) {
  if (law.kind == PairLaw::Kind::viscosity) return 0;
  if (law.kind == PairLaw::Kind::soft_repulsion) {
    const double depth = law.cutoff - std::sqrt(r2);
    return 0.5 * law.strength * depth * depth;
  }
  const double e2 = law.softening * law.softening;
  const auto unshifted = [&](double q) {
    if (!(q > 0)) return 0.0;
    if (law.exponent == 1) return 0.5 * law.strength * trig::log(q);
    double p = law.exponent % 2 == 1 ? 1.0 : 1 / std::sqrt(q);
    for (int k = (law.exponent - 1) / 2; k > 0; --k) p /= q;
    return -law.strength * p / (law.exponent - 1);
  };
  return unshifted(r2 + e2) - unshifted(law.cutoff * law.cutoff + e2);
}

}  // namespace truestep
