// The longest substeps that a state allows: by its fastest particle, body or wall, sound, weight, tension and
// viscosity.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/systems/sph/fluid.h"
#include "engine/systems/sph/solvers/layer_load.h"

namespace truestep::sph {

template <int D, class T>
class Allowed {
 public:
  explicit Allowed(const Setting& set)
      : set_(set), viscous_(set.def.viscosity > 0 && !set.def.solves_viscosity()) {}

  /// s: the longest substep, and the longest without the limit of viscosity, in which the flow moves as far
  /// as a substep may. `crossed` is the part of that way which the fastest makes in it without falling: small
  /// in a flow that hardly moves.
  struct Lengths {
    double substep, flow, crossed;
  };
  /// `solids` (m/s) is the fastest of bodies and walls.
  Lengths operator()(const State& s, Fluid<D, T>& f, double solids, const Vec3& gravity,
                     const ThreadArena& arena) const {
    const SphDef& d = set_.def;
    const double speed = fastest(s, f, solids, arena);
    double out = std::min(by_speed(speed, gravity), by_weight(s, f, gravity, arena));
    if (d.surface_tension > 0) {
      const double inertia = d.density * set_.lightest * d.spacing * d.spacing * d.spacing;
      out = std::min(out, kCapillary * std::sqrt(inertia / d.surface_tension));
    }
    const double crossed = speed > 0 ? speed * out / (d.courant * d.spacing) : 0;
    if (!viscous_) return {out, out, crossed};
    return {std::min(out, kDiffusion * set_.support * set_.support / d.viscosity), out, crossed};
  }

  /// s, in which a particle falls as far as it may: with longer substeps a pool does not come to rest.
  double by_fall(double gravity) const;

 private:
  /// m/s, of particles, nozzles and solids.
  double fastest(const State& s, Fluid<D, T>& f, double solids, const ThreadArena& arena) const;

  double by_speed(double speed, const Vec3& gravity) const;

  /// By the weight that the solves of dfsph and pbf have to carry.
  double by_weight(const State& s, Fluid<D, T>& f, const Vec3& gravity, const ThreadArena& arena) const;

  /// Fraction of the period of the shortest wave of surface tension: sqrt(rho s^3 / (2 pi sigma)) over 2.5.
  static constexpr double kCapillary = 0.16;
  static constexpr double kFall = 0.09;  ///< of the time in which a particle falls half a spacing
  /// For pbf, the largest g H (h / s)^2 per iteration of a substep at which a pool H deep keeps its order
  /// under compression: at twice as much, corrections shoot particles out. A single iteration, with no second
  /// one to correct it, overshoots much earlier.
  static constexpr double kCarried = 0.09, kCarriedByOne = 0.012;
  /// The same between liquids of different density, by the load on the lightest (layer_load.h): at 0.2 two of
  /// 100:1 burst, at 0.02 the first corrections add 2 % of energy, at 0.04 layers that start unevenly are
  /// compressed by 3.2 % on the mean.
  static constexpr double kCarriedLayers = 0.035;
  /// For dfsph between such liquids, the largest h sqrt(p / rho) / s, p and rho of a particle: at 1.3 the
  /// light liquid collapses. Pressures that separate an overlap count up to so many times the weight.
  static constexpr double kHeld = 0.6, kMostOverWeight = 4;
  static constexpr double kDiffusion = 0.03;  ///< of the squared kernel radius: Morris, Fox & Zhu 1997

  const Setting& set_;
  bool viscous_;
};

}  // namespace truestep::sph
