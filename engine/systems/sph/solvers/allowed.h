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
  double by_fall(double gravity) const {
    return gravity > 0 ? kFall * std::sqrt(set_.def.spacing / gravity) : HUGE_VAL;
  }

 private:
  /// m/s, of particles, nozzles and solids.
  double fastest(const State& s, Fluid<D, T>& f, double solids, const ThreadArena& arena) const {
    const auto v = s.span<T>(columns::velocity);
    f.partial.assign((f.n + kBlockRows - 1) / kBlockRows, 0);
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      double most = 0;
      for (size_t k = begin; k < end; ++k) {
        double square = 0;
        for (size_t a = 0; a < D; ++a) square += double{v[3 * k + a]} * double{v[3 * k + a]};
        if (!(square <= most)) most = square;
      }
      f.partial[begin / kBlockRows] = most;
    });
    double most = solids * solids;
    for (const Inlet& inlet : set_.inlets) most = std::max(most, inlet.speed * inlet.speed);
    for (const double square : f.partial) {
      if (!(square <= most)) most = square;
    }
    return std::sqrt(most);
  }

  double by_speed(double speed, const Vec3& gravity) const {
    const SphDef& d = set_.def;
    const double sound = d.solver == Method::wcsph ? set_.sound / std::sqrt(set_.lightest) : 0;
    const double half = 0.5 * (speed + sound), reach = d.courant * d.spacing;
    // Speed that includes acceleration by gravity on the way.
    const double way = half + std::sqrt(half * half + norm(gravity) * reach);
    return way > 0 ? reach / way : way == 0 ? HUGE_VAL : way;
  }

  /// By the weight that the solves of dfsph and pbf have to carry.
  double by_weight(const State& s, Fluid<D, T>& f, const Vec3& gravity, const ThreadArena& arena) const {
    const SphDef& d = set_.def;
    const double g = norm(gravity);
    if (!(g > 0) || d.solver == Method::wcsph) return HUGE_VAL;
    double out = by_fall(g);
    const T* place = s.span<T>(columns::position).data();
    const auto load = [&] {
      return load_by_weight<D>(set_, place, s.span<T>(set_.ratio).data(), f.n, gravity, f.partial);
    };
    if (d.solver == Method::pbf) {
      const double under = std::max(depth<D>(place, f.n, gravity / g, f.partial, arena), d.spacing);
      const double most = d.pbf_iterations == 1 ? kCarriedByOne : kCarried;
      out = std::min(out, d.spacing * std::sqrt(most * d.pbf_iterations / (g * under)));
      // Not by the pressures found: those of a shorter substep are larger, and would shorten the next.
      if (set_.ratio) {
        const double layers = std::min(most, kCarriedLayers) * d.pbf_iterations, by = load();
        if (by > 0) out = std::min(out, d.spacing * std::sqrt(layers / by));
      }
    } else if (set_.ratio) {
      const double found = load_of_pressures(s.span<T>(columns::push).data(), s.span<T>(columns::flow).data(),
                                             s.span<T>(set_.ratio).data(), f.n, f.partial, arena);
      out = std::min(out, kHeld * d.spacing / std::sqrt(std::min(found, kMostOverWeight * load())));
    }
    return out;
  }

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
