// Rows of the table: implicit methods of adaptive step for stiff equations.
#include <array>
#include <limits>

#include "engine/integrators/field_equations.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/table/methods.h"
#include "engine/integrators/table/rows.h"

namespace truestep {

namespace {

/// L-stable methods with an error estimate.
template <AdvanceFunction* advance>
Integrator stiff(std::string_view name, std::string_view title, int order, std::string_view source) {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  return {.name = name,
          .title = title,
          .order = order,
          .imaginary_limit = kUnlimited,
          .real_limit = kUnlimited,
          .stepping = Integrator::Stepping::adaptive,
          .kind = Integrator::Kind::implicit,
          .order_with_velocity = order,
          .source = source,
          .prepare = prepare_adaptive,
          .step = step_by<advance>,
          .advance = advance,
          .refuses = refuses_without_jacobian};
}

}  // namespace

std::span<const Integrator> stiff_rows() {
  static const std::array kRows = {
      stiff<advance_tr_bdf2>("tr_bdf2", "trapezoidal rule and BDF2 in one step, L-stable", 2,
                             "Bank et al. 1985; Hosea, Shampine 1996, table 1"),
      stiff<advance_sdirk4>("sdirk4", "singly diagonally implicit Runge-Kutta method, L-stable", 4,
                            "Hairer, Wanner 1996, table IV.6.5"),
      stiff<advance_rodas5p>("rodas5p", "Rosenbrock method Rodas5P, L-stable", 5,
                             "Steinebach 2023, tables 3 and 4"),
      stiff<advance_radau5>("radau5", "Radau IIA collocation with three stages, L-stable", 5,
                            "Hairer, Wanner 1996, section IV.8"),
  };
  return kRows;
}

}  // namespace truestep
