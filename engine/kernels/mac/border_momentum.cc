#include "engine/kernels/mac/border_momentum.h"

#include <algorithm>
#include <cmath>

namespace truestep::mac {

void mass_flux(const MacGrid& g, size_t axis, const double* u, double h, const TwoDensities& d, double* flux,
               const ThreadArena& arena) {
  const double per = h / g.spacing[axis];
  for_rows(g, axis, arena, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) flux[i] = d.first * per * u[i] + (d.second - d.first) * flux[i];
  });
}

void carry_momentum(const MacGrid& g, size_t c, size_t axis, Sweep sweep, const ConstFields& u, double h,
                    const TwoDensities& d, const double* share, const double* full, const double* mass,
                    const double* q, double* to, const ThreadArena& arena) {
  const size_t s = g.stride(axis), sc = g.stride(c);
  const double least = 1e-3 * std::min(d.first, d.second);
  // Mass that the axis adds to a cell beyond what its fluxes do, as carry_share adds volume.
  const auto swells = [&](size_t cell) {
    double by = 0;
    for (size_t a = 0; a < g.dimensions; ++a) {
      if ((a == axis) != (sweep == Sweep::inner)) continue;
      const double out = h / g.spacing[a] * (u[a][cell + g.stride(a)] - u[a][cell]);
      by += sweep == Sweep::inner ? out : -out;
    }
    return d.of(full[cell]) * by;
  };
  const auto mass_of = [&](size_t face) { return 0.5 * (d.of(share[face - sc]) + d.of(share[face])); };
  // What crosses between two faces: the upwind face's velocity with van Leer's slope; the part of its mass
  // that leaves takes the slope with it, so that what stays is not further off than its neighbours.
  const auto crossing = [&](size_t behind, size_t ahead, size_t further, double flux) {
    const double to_ahead = q[ahead] - q[behind], from_further = q[behind] - q[further];
    const double both = to_ahead * from_further;
    const double slope = both > 0 ? 2 * both / (to_ahead + from_further) : 0;
    const double left = std::max(0.0, 1 - std::abs(flux) / mass_of(behind));
    return flux * (q[behind] + 0.5 * left * slope);
  };
  for_rows(g, c, arena, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) {
      const size_t before = i - sc;
      double low = 0, high = 0;
      if (axis == c) {
        low = 0.5 * (mass[i - s] + mass[i]), high = 0.5 * (mass[i] + mass[i + s]);
      } else {
        low = 0.5 * (mass[before] + mass[i]), high = 0.5 * (mass[before + s] + mass[i + s]);
      }
      const double more = 0.5 * (swells(before) + swells(i)), had = mass_of(i);
      const double has = std::max(had - (high - low) + more, least);
      const double in = low > 0 ? crossing(i - s, i, i - 2 * s, low) : crossing(i, i - s, i + s, low);
      const double out = high > 0 ? crossing(i, i + s, i - s, high) : crossing(i + s, i, i + 2 * s, high);
      to[i] = ((had + more) * q[i] - (out - in)) / has;
    }
  });
}

bool beside_border(const MacGrid& g, size_t c, const double* share, size_t at) {
  // Sums of shares are rounded.
  constexpr double kSame = 1e-8;
  const size_t sc = g.stride(c);
  const auto of = [&](size_t face) { return share[face - sc] + share[face]; };
  const double here = of(at);
  for (size_t a = 0; a < g.dimensions; ++a) {
    const size_t s = g.stride(a);
    if (std::abs(of(at + s) - here) > kSame || std::abs(of(at - s) - here) > kSame) return true;
  }
  return false;
}

}  // namespace truestep::mac
