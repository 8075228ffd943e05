// Rows of the table: implicit Euler by a given number of descent iterations, for networks of springs. They
// promise no stable step: it depends on how far the iterations converge.
#include <array>
#include <limits>

#include "engine/integrators/table/methods.h"
#include "engine/integrators/table/rows.h"

namespace truestep {

namespace {

Integrator descent(std::string_view name, std::string_view title, std::string_view source, StepFunction* step,
                   RefusalFunction* refuses) {
  constexpr double kNoPromise = std::numeric_limits<double>::quiet_NaN();
  return {.name = name,
          .title = title,
          .order = 1,
          .imaginary_limit = kNoPromise,
          .real_limit = kNoPromise,
          .kind = Integrator::Kind::implicit,
          .order_with_velocity = 1,
          .source = source,
          .step = step,
          .refuses = refuses};
}

}  // namespace

std::span<const Integrator> descent_rows() {
  static const std::array kRows = [] {
    std::array rows = {descent("projective_dynamics", "implicit Euler by a constant factorisation and L-BFGS",
                               "Bouaziz and others 2014; Liu, Bouaziz, Kavan 2017, algorithm 1",
                               step_projective_dynamics, refuses_without_bound),
                       descent("vertex_block_descent", "implicit Euler point by point, colour after colour",
                               "Chen, Liu, Yang, Yuksel 2024, section 3", step_vertex_block_descent,
                               refuses_without_point_forces)};
    rows[1].prepare = prepare_vertex_block_descent;
    return rows;
  }();
  return kRows;
}

}  // namespace truestep
