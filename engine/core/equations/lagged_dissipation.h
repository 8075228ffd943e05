// Interface of fields whose dissipative forces can be evaluated at other positions than the rest: with
//   f = -dV/dx(x) - dR/du(x_l, u),  x_l held,
// a step of an implicit method is the minimum of a potential, which a line search always finds.
#pragma once
#include "engine/core/equations/force_field.h"

namespace truestep {

class LaggedDissipation {
 public:
  virtual ~LaggedDissipation() = default;
  /// ForceField::acceleration with the forces of R (ForceField::dissipation) taken at `x_lagged`.
  virtual void lagged_acceleration(const Phase& at, std::span<const double> x_lagged, std::span<double> a,
                                   Evaluation& e) const = 0;
};

}  // namespace truestep
