// The rows every force system's table has for its integrator.
#pragma once
#include "engine/core/build.h"
#include "engine/core/def.h"

namespace truestep {

/// Members that add_integrator_rows expects; systems' structs derive from it.
struct IntegratorParams {
  std::string integrator;
  std::optional<double> tolerance, newton_tolerance, relative_tolerance, absolute_tolerance;

  IntegratorChoice choice() const {
    IntegratorChoice c;
    c.name = integrator;
    if (tolerance) c.options.tolerance = *tolerance;
    if (newton_tolerance) c.options.newton_tolerance = *newton_tolerance;
    c.options.relative_tolerance = relative_tolerance, c.options.absolute_tolerance = absolute_tolerance;
    return c;
  }
};

/// Adds "integrator", "tolerance", "newton_tolerance", "relative_tolerance" and "absolute_tolerance" to the
/// table of a struct D derived from IntegratorParams.
template <class D>
TableOf<D>& add_integrator_rows(TableOf<D>& table) {
  std::string D::*integrator = &IntegratorParams::integrator;
  std::optional<double> D::*tolerance = &IntegratorParams::tolerance;
  std::optional<double> D::*newton_tolerance = &IntegratorParams::newton_tolerance;
  std::optional<double> D::*relative = &IntegratorParams::relative_tolerance;
  std::optional<double> D::*absolute = &IntegratorParams::absolute_tolerance;
  return table
      .text("integrator", integrator, "time integration method; GET /v1/systems/{type} lists those that fit")
      .number("tolerance", tolerance, "1", above(0), "adaptive methods: bound on the local error of a step")
      .number("newton_tolerance", newton_tolerance, "1", above(0),
              "implicit methods: relative residual at which Newton's method stops")
      .number("relative_tolerance", relative, "1", at_least(0),
              "adaptive methods: the error of a step may be absolute_tolerance + this times the value")
      .number("absolute_tolerance", absolute, "1", above(0),
              "adaptive methods: see there; default: tolerance");
}

}  // namespace truestep
