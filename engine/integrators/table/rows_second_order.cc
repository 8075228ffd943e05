// Rows of the table: methods of high order for equations of second order.
#include <array>
#include <limits>

#include "engine/integrators/field_equations.h"
#include "engine/integrators/table/methods.h"
#include "engine/integrators/table/rows.h"

namespace truestep {

std::span<const Integrator> second_order_rows() {
  constexpr double kNoPromise = std::numeric_limits<double>::quiet_NaN();
  using Stepping = Integrator::Stepping;
  using Equations = Integrator::Equations;
  static const std::array kRows = {
      Integrator{.name = "rkn86",
                 .title = "Runge-Kutta-Nystroem pair of order 8 and 6",
                 .order = 8,
                 .imaginary_limit = 3.14025416253900649749,
                 .real_limit = kNoPromise,
                 .stepping = Stepping::adaptive,
                 .equations = Equations::without_velocity,
                 .order_with_velocity = 0,
                 .source = "Dormand, El-Mikkawy, Prince 1987, RKN8(6)9FM",
                 .prepare = prepare_compensated,
                 .step = step_by<advance_rkn86>,
                 .memory = compensated_memory,
                 .advance = advance_rkn86,
                 .refuses = refuses_general_rates},
      Integrator{.name = "rkn1210",
                 .title = "Runge-Kutta-Nystroem pair of order 12 and 10",
                 .order = 12,
                 .imaginary_limit = 8.3262010537773137041,
                 .real_limit = kNoPromise,
                 .stepping = Stepping::adaptive,
                 .equations = Equations::without_velocity,
                 .order_with_velocity = 0,
                 .source = "Dormand, El-Mikkawy, Prince 1987, RKN12(10)17M",
                 .prepare = prepare_compensated,
                 .step = step_by<advance_rkn1210>,
                 .memory = compensated_memory,
                 .advance = advance_rkn1210,
                 .refuses = refuses_general_rates},
      Integrator{.name = "ias15",
                 .title = "Gauss-Radau predictor-corrector of order 15 with compensated sums",
                 .order = 15,
                 .imaginary_limit = kNoPromise,
                 .real_limit = kNoPromise,
                 .stepping = Stepping::adaptive,
                 .equations = Equations::second_order,
                 .order_with_velocity = 15,
                 .source = "Everhart 1985; Rein, Spiegel 2015",
                 .prepare = prepare_ias15,
                 .step = step_by<advance_ias15>,
                 .memory = ias15_memory,
                 .advance = advance_ias15,
                 .refuses = refuses_general_rates},
  };
  return kRows;
}

}  // namespace truestep
