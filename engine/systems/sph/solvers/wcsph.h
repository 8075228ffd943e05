// Weakly compressible SPH: pressure by Tait's equation (Monaghan 1994), density by continuity with the
// diffusion of delta-SPH (Molteni & Colagrossi 2009; without the hydrostatic part, as by Fourtakas et al.
// 2019), Monaghan's artificial viscosity. Velocity first, then density and position with it.
#pragma once
#include "engine/systems/sph/bodies.h"

namespace truestep::sph {

/// p / rho0 (m^2/s^2) as a function of relative density.
template <class T>
inline T tait(T delta, T sound) {
  const T d2 = delta * delta, d7 = d2 * d2 * d2 * delta;
  return sound * sound / 7 * (d7 - 1);
}

template <int D, class T>
class Wcsph {
 public:
  explicit Wcsph(const Setting& set) : set_(set) {}

  /// Velocities and densities (f.delta, which here is not list()'s sum) after h s.
  void advance(Fluid<D, T>& f, BodiesIn<D, T>& bodies, const Vec3& gravity, double h,
               const ThreadArena& arena) const;

 private:
  using W = Wide<T>;
  static constexpr T kLeastDensity = T(0.5), kMostDensity = T(2);

  /// Adds alpha h c sum (v_ij . x_ij) / r^2 g to f.a, over pairs that approach each other.
  void brake(Fluid<D, T>& f, const ThreadArena& arena) const;

  const Setting& set_;
};

}  // namespace truestep::sph
