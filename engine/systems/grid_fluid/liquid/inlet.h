// A nozzle that pours a liquid on a grid (collision/points/nozzle.h). It is two cells deep: particles start
// at its back and move with it; faces in the half before its mouth have its speed, and what it pours appears
// in the cells behind them.
#pragma once
#include "engine/collision/points/nozzle.h"
#include "engine/systems/grid_fluid/grid_fluid_def.h"

namespace truestep::grid_fluid {

struct LiquidInlet : Nozzle {
  LiquidInlet(const GridFluidDef& d, const LiquidInletDef& e)
      : LiquidInlet(make_grid(d), d.particles_per_axis, e) {}

  double spacing;  ///< m, of its particles
  double dye;
  /// Whether liquid is pressed through it at time t (s).
  bool pours(double t) const { return t >= start && t < stop; }
  /// Whether a point (m) lies in it.
  bool contains(const Vec3& at) const {
    const Vec3 from = at - mouth;
    const double way = dot(from, along);
    return way < 0 && way >= -depth && norm2(from - along * way) < reach * reach;
  }

 private:
  LiquidInlet(const mac::MacGrid& g, int per_axis, const LiquidInletDef& e)
      : Nozzle(e, {static_cast<int>(g.dimensions), g.spacing[0] / per_axis, 2 * g.spacing[0],
                   std::max({g.extent(0), g.extent(1), g.dimensions == 3 ? g.extent(2) : 0.0})}),
        spacing(g.spacing[0] / per_axis),
        dye(e.dye.value_or(0)) {}
};

}  // namespace truestep::grid_fluid
