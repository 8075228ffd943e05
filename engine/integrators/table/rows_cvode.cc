// Rows of the table: CVODE.
#include <array>
#include <limits>

#include "engine/integrators/field_equations.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/table/methods.h"
#include "engine/integrators/table/rows.h"

namespace truestep {

std::span<const Integrator> cvode_rows() {
  constexpr double kNoPromise = std::numeric_limits<double>::quiet_NaN();
  using Stepping = Integrator::Stepping;
  using Kind = Integrator::Kind;
  static const std::array kRows = {
      Integrator{.name = "cvode_bdf",
                 .title = "CVODE, backward differentiation of order 1 to 5",
                 .order = 5,
                 .imaginary_limit = kNoPromise,
                 .real_limit = kNoPromise,
                 .stepping = Stepping::adaptive,
                 .kind = Kind::implicit,
                 .order_with_velocity = 5,
                 .source = "Hindmarsh et al. 2005; SUNDIALS 6.4",
                 .prepare = prepare_cvode,
                 .step = step_by<advance_cvode_bdf, MethodHistory::repeated>,
                 .memory = cvode_memory,
                 .advance = advance_cvode_bdf,
                 .refuses = refuses_without_jacobian},
      Integrator{.name = "cvode_adams",
                 .title = "CVODE, Adams methods of order 1 to 12",
                 .order = 12,
                 .imaginary_limit = kNoPromise,
                 .real_limit = kNoPromise,
                 .stepping = Stepping::adaptive,
                 .order_with_velocity = 12,
                 .source = "Hindmarsh et al. 2005; SUNDIALS 6.4",
                 .prepare = prepare_cvode,
                 .step = step_by<advance_cvode_adams, MethodHistory::repeated>,
                 .memory = cvode_memory,
                 .advance = advance_cvode_adams},
  };
  return kRows;
}

}  // namespace truestep
