// The rows every force system's table has for its integrator.
#pragma once
#include "engine/core/build.h"
#include "engine/core/def.h"

namespace truestep {

/// Adds "integrator", "tolerance", "newton_tolerance" to the table of a struct with a member
/// IntegratorChoice-like flat members: std::string integrator; std::optional<double> tolerance,
/// newton_tolerance.
template <class D>
TableOf<D>& add_integrator_rows(TableOf<D>& table) {
  return table
      .text("integrator", &D::integrator,
            "time integration method; GET /v1/systems/{type} lists those that fit")
      .number("tolerance", &D::tolerance, "1", above(0),
              "adaptive methods: bound on the local error of a step")
      .number("newton_tolerance", &D::newton_tolerance, "1", above(0),
              "implicit methods: relative residual at which Newton's method stops");
}

/// Members that add_integrator_rows expects; systems' structs derive from it.
struct IntegratorParams {
  std::string integrator;
  std::optional<double> tolerance, newton_tolerance;

  IntegratorChoice choice() const {
    IntegratorChoice c;
    c.name = integrator;
    if (tolerance) c.options.tolerance = *tolerance;
    if (newton_tolerance) c.options.newton_tolerance = *newton_tolerance;
    return c;
  }
};

}  // namespace truestep
