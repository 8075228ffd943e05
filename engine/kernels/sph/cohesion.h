// Cohesion of a liquid's particles (Akinci, Akinci & Teschner 2013, equation 2): with q = r / H the force of
// a pair is proportional to C(q) = (1 - q)^3 q^3 for q > 1/2 and 2 (1 - q)^3 q^3 - 1/64 below, so particles
// attract each other and repel when too close. The strength is set from the surface tension, which is the
// energy of the bonds that a cut of unit area divides, over its two sides.
#pragma once
#include <cmath>

#include "engine/math/wide.h"

namespace truestep::sph {

/// C of q in [0, 1].
template <class T>
inline Wide<T> cohesion(const Wide<T>& q) {
  using W = Wide<T>;
  const W one = W::all(1), p = q * (one - q), cube = p * p * p;
  return select(q < W::all(T(0.5)), cube + cube - W::all(T(1.0 / 64)), cube);
}

/// Work (integral of C over q) that takes a pair from q to beyond the kernel.
inline double cohesion_work(double q) {
  // The integral of q^3 (1 - q)^3 and its parts on both sides of a half.
  const auto beyond = [](double a) {
    const auto at = [](double x) {
      return x * x * x * x * (1.0 / 4 - x * (3.0 / 5 - x * (1.0 / 2 - x / 7)));
    };
    return at(1) - at(a);
  };
  if (q >= 1) return 0;
  if (q >= 0.5) return beyond(q);
  return beyond(0.5) + 2 * (beyond(q) - beyond(0.5)) - (0.5 - q) / 64;
}

/// Force over mass (m/s^2) of a pair at C = 1 that gives tension (N/m) to a liquid of density rho (kg/m^3; in
/// the plane a metre thick) whose particles lie on a lattice of `spacing` (m) with a kernel of radius
/// `support` (m). Bonds along a lattice vector r cross unit area of a plane of normal z n (r . z)+ times,
/// which averages over directions to n r / 4, and to n r / pi in the plane.
inline double cohesion_strength(double tension, double rho, int dimension, double spacing, double support) {
  constexpr double kPi = 3.14159265358979323846;
  const int reach = static_cast<int>(support / spacing) + 1, reach_z = dimension == 3 ? reach : 0;
  double bonds = 0;
  for (int z = -reach_z; z <= reach_z; ++z) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const double r = spacing * std::sqrt(static_cast<double>(x * x + y * y + z * z));
        if (r > 0) bonds += r * cohesion_work(r / support) * support;
      }
    }
  }
  const double crossing = dimension == 3 ? 0.25 : 1 / kPi;
  return tension / (0.5 * crossing * rho * bonds);
}

}  // namespace truestep::sph
