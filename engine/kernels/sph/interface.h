// Surface tension as the energy of an interface. With q = r / H, d the offset to a neighbour and poly6
// (Mueller, Charypar & Gross 2003) as the kernel, each particle has
//   c = sum (1 - q^2)^3 over that of a lattice,   n = sum psi(q) d,   psi = q (1 - q^2)^2;
// n vanishes in a lattice however strained, and points into the liquid at its surface. The energy
//   E = e sum (phi(|n|) + b (1 - c)^2),   phi = sqrt(n^2 + eps^2) - eps
// is proportional to the surface's area. Of its two parts (compare Cahn & Hilliard 1958) the first drives
// particles out of the surface, the second holds them, and b balances the two in a plane. Its gradient
// conserves energy and both momenta; no curvature is computed:
//   F_i = (e / H) sum J (m_i - m_j) + B (u_i + u_j) psi d,   m = n / sqrt(n^2 + eps^2),   u = 2 (1 - c),
//   J = (1 - q^2) ((1 - q^2) I - 4 q^2 d d'),   B = 6 b over the lattice's sum.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

namespace truestep::sph {

/// The plane surface of a lattice.
struct PlaneInterface {
  double softness = 0;  ///< eps
  double whole = 1;     ///< sum of (1 - q^2)^3 over the lattice
  double hold = 0;      ///< B
  double energy = 0;    ///< 1/m^(dimension - 1), energy of unit area over e

  /// eps over n of the outermost layer: small enough that disorder inside the liquid costs little.
  static constexpr double kSoftness = 0.2;
  /// b over its balanced value: a particle slightly outside the surface is drawn back.
  static constexpr double kHold = 1.6;

  /// For points `spacing` (m) apart and a kernel of radius `support` (m).
  PlaneInterface(int dimension, double spacing, double support) {
    const int reach = static_cast<int>(support / spacing) + 1, reach_z = dimension == 3 ? reach : 0;
    // visit(layers below, q, offset downwards over distance) for each point `from` or more layers below.
    const auto each = [&](int from, const auto& visit) {
      for (int y = from; y <= reach; ++y) {
        for (int z = -reach_z; z <= reach_z; ++z) {
          for (int x = -reach; x <= reach; ++x) {
            const double r = std::sqrt(static_cast<double>(x * x + y * y + z * z));
            const double q = r * spacing / support;
            if (q < 1) visit(y, q, r > 0 ? y / r : 0);
          }
        }
      }
    };
    const auto value = [](double q) { return (1 - q * q) * (1 - q * q) * (1 - q * q); };
    const auto psi = [](double q) { return q * (1 - q * q) * (1 - q * q); };
    whole = 0;
    each(-reach, [&](int, double q, double) { whole += value(q); });
    const auto layers = static_cast<size_t>(reach) + 1;
    std::vector<double> n(layers), c(layers), m(layers), u(layers);
    for (size_t k = 0; k < layers; ++k) {
      each(-static_cast<int>(k),
           [&](int, double q, double down) { c[k] += value(q) / whole, n[k] += psi(q) * down; });
      u[k] = 2 * (1 - c[k]);
    }
    softness = kSoftness * n[0];
    for (size_t k = 0; k < layers; ++k) m[k] = n[k] / std::sqrt(n[k] * n[k] + softness * softness);
    // Component into the liquid, for a particle of the outermost layer.
    double drive = 0, held = 0;
    each(0, [&](int y, double q, double down) {
      const auto at = static_cast<size_t>(y);
      const double p = 1 - q * q;
      drive += p * (p - 4 * q * q * down * down) * (m[0] - m[at]);
      held += (u[0] + u[at]) * psi(q) * down;
    });
    hold = kHold * std::max(-drive, 0.0) / held;
    for (size_t k = 0; k < layers; ++k) {
      energy += std::sqrt(n[k] * n[k] + softness * softness) - softness + hold * whole / 24 * u[k] * u[k];
    }
    energy /= dimension == 3 ? spacing * spacing : spacing;
  }
};

}  // namespace truestep::sph
