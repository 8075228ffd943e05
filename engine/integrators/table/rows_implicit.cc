// Rows of the table: implicit methods of fixed step.
#include <array>
#include <limits>

#include "engine/integrators/field_equations.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/table/methods.h"
#include "engine/integrators/table/rows.h"

namespace truestep {

namespace {

/// Unconditionally stable methods of order 1 and 2; differences are set afterwards.
Integrator implicit(std::string_view name, std::string_view title, int order, std::string_view source,
                    StepFunction* step) {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  return {.name = name,
          .title = title,
          .order = order,
          .imaginary_limit = kUnlimited,
          .real_limit = kUnlimited,
          .kind = Integrator::Kind::implicit,
          .order_with_velocity = order,
          .source = source,
          .step = step,
          .refuses = refuses_without_jacobian};
}
/// With a second path for force fields, solved block by block: `./truestep bench newton_cloth`.
Integrator by_blocks(Integrator row, AdvanceFunction* advance) {
  row.advance = advance;
  return row;
}
template <AdvanceFunction* advance>
Integrator implicit(std::string_view name, std::string_view title, std::string_view source) {
  Integrator row = implicit(name, title, 2, source, step_by<advance>);
  row.advance = advance;
  return row;
}
template <AdvanceFunction* advance>
Integrator structural(std::string_view name, std::string_view title, std::string_view source) {
  Integrator row = implicit<advance>(name, title, source);
  row.equations = Integrator::Equations::second_order;
  row.refuses = refuses_first_order;
  return row;
}
Integrator symplectic(Integrator row) {
  row.structure = Integrator::Structure::symplectic;
  return row;
}
Integrator counting(Integrator row, ObserveFunction* observe) {
  row.observe = observe;
  return row;
}
Integrator bounded(Integrator row, IntervalFunction* interval) {
  row.interval = interval;
  return row;
}
Integrator remembering(Integrator row, PrepareFunction* prepare, MemoryFunction* memory) {
  row.prepare = prepare, row.memory = memory;
  return row;
}

}  // namespace

std::span<const Integrator> implicit_rows() {
  static const std::array kRows = {
      by_blocks(counting(remembering(implicit("implicit_euler",
                                              "implicit Euler, Newton's method on the full equations", 1,
                                              "Hairer, Wanner 1996, eq. IV.3.1", step_implicit_euler),
                                     prepare_implicit_euler, nullptr),
                         observe_implicit_euler),
                advance_implicit_euler),
      by_blocks(implicit("linear_implicit_euler", "implicit Euler with one Newton step", 1,
                         "Baraff, Witkin 1998, eq. 6; Hairer, Wanner 1996, section IV.9",
                         step_linear_implicit_euler),
                advance_linear_implicit_euler),
      symplectic(implicit<advance_implicit_midpoint>("implicit_midpoint", "implicit midpoint rule",
                                                     "Hairer, Lubich, Wanner 2006, eq. I.1.7")),
      implicit<advance_trapezoid>("trapezoid", "trapezoidal rule (Crank-Nicolson)",
                                  "Hairer, Wanner 1996, section IV.3"),
      remembering(implicit<advance_bdf2>("bdf2", "backward differentiation of order 2, L-stable",
                                         "Hairer, Norsett, Wanner 1993, section III.5"),
                  prepare_bdf2, bdf2_memory),
      bounded(structural<advance_newmark>("newmark", "Newmark's method, average acceleration by default",
                                          "Newmark 1959"),
              newmark_interval),
      remembering(structural<advance_generalized_alpha>(
                      "generalized_alpha",
                      "generalized-alpha method, damps high frequencies to a chosen spectral radius",
                      "Chung, Hulbert 1993, eq. 13 to 25"),
                  prepare_generalized_alpha, generalized_alpha_memory),
  };
  return kRows;
}

}  // namespace truestep
