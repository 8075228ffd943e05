// The rows for the integrator in the table of every force system.
#pragma once
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"

namespace truestep {

/// Members that add_integrator_rows expects; the systems' structs derive from it.
struct IntegratorParams {
  std::string integrator;
  std::optional<double> tolerance, newton_tolerance, relative_tolerance, absolute_tolerance;
  std::optional<double> spectral_radius, newmark_beta, newmark_gamma;
  std::optional<int> max_internal_steps, descent_iterations;

  IntegratorChoice choice() const {
    IntegratorChoice c;
    c.name = integrator;
    if (tolerance) c.options.tolerance = *tolerance;
    if (newton_tolerance) c.options.newton_tolerance = *newton_tolerance;
    c.options.relative_tolerance = relative_tolerance, c.options.absolute_tolerance = absolute_tolerance;
    if (spectral_radius) c.options.damping.spectral_radius = *spectral_radius;
    if (newmark_beta) c.options.damping.newmark_beta = *newmark_beta;
    if (newmark_gamma) c.options.damping.newmark_gamma = *newmark_gamma;
    if (max_internal_steps) c.options.max_internal_steps = *max_internal_steps;
    if (descent_iterations) c.options.descent_iterations = *descent_iterations;
    return c;
  }
};

/// Adds "integrator" and the settings of IntegratorParams, each under its member's name, to the table of a
/// struct D derived from it.
template <class D>
TableOf<D>& add_integrator_rows(TableOf<D>& table) {
  std::string D::*integrator = &IntegratorParams::integrator;
  std::optional<double> D::*tolerance = &IntegratorParams::tolerance;
  std::optional<double> D::*newton_tolerance = &IntegratorParams::newton_tolerance;
  std::optional<double> D::*relative = &IntegratorParams::relative_tolerance;
  std::optional<double> D::*absolute = &IntegratorParams::absolute_tolerance;
  std::optional<double> D::*radius = &IntegratorParams::spectral_radius;
  std::optional<double> D::*beta = &IntegratorParams::newmark_beta;
  std::optional<double> D::*gamma = &IntegratorParams::newmark_gamma;
  std::optional<int> D::*most = &IntegratorParams::max_internal_steps;
  std::optional<int> D::*descents = &IntegratorParams::descent_iterations;
  return table
      .text("integrator", integrator, "time integration method; GET /v1/systems/{type} lists those that fit")
      .number("tolerance", tolerance, "1", above(0),
              "adaptive methods: default of relative_tolerance and absolute_tolerance")
      .number("newton_tolerance", newton_tolerance, "1", above(0),
              "implicit methods: relative residual at which Newton's method stops")
      .number("relative_tolerance", relative, "1", at_least(0),
              "adaptive methods: allowed error of an unknown per step is absolute_tolerance + this times its "
              "value, root mean square over all unknowns")
      .number("absolute_tolerance", absolute, "1", above(0), "adaptive methods: see relative_tolerance")
      .number("spectral_radius", radius, "1", between(0, 1),
              "generalized_alpha: factor on the amplitude of the highest modes per step; default 0.9")
      .number("newmark_beta", beta, "1", between(0, 1),
              "newmark: weight of the new acceleration in the position; default 1/4, unconditionally stable "
              "if 2 beta >= gamma")
      .number("newmark_gamma", gamma, "1", between(0.5, 1.5),
              "newmark: the same for the velocity; default 1/2, larger values damp and reduce the order to 1")
      .integer("max_internal_steps", most, between(1, 1e7),
               "adaptive methods: maximum number of internal steps per step; then the run fails; default "
               "100000")
      .integer("descent_iterations", descents, between(1, 1e5),
               "projective_dynamics, vertex_block_descent: iterations per step; default 10");
}

}  // namespace truestep
