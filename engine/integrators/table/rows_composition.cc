// Rows of the table: symplectic compositions of leapfrogs and of kicks and drifts.
#include <array>

#include "engine/integrators/table/methods.h"
#include "engine/integrators/table/rows.h"

namespace truestep {

std::span<const Integrator> composition_rows() {
  using Structure = Integrator::Structure;
  using Equations = Integrator::Equations;
  static const std::array kRows = {
      Integrator{.name = "yoshida4",
                 .title = "Yoshida's composition of three leapfrogs",
                 .order = 4,
                 .imaginary_limit = 1.57340194743454005662957947736,
                 .real_limit = 0.893399012419685359318014750968,
                 .structure = Structure::symplectic,
                 .equations = Equations::second_order,
                 .order_with_velocity = 3,
                 .source = "Yoshida 1990, eq. 2.13",
                 .step = step_yoshida4,
                 .advance = advance_yoshida4},
      Integrator{.name = "yoshida6",
                 .title = "Yoshida's composition of seven leapfrogs",
                 .order = 6,
                 .imaginary_limit = 2.26905799639765941787,
                 .real_limit = 1.1452311157515217746,
                 .structure = Structure::symplectic,
                 .equations = Equations::second_order,
                 .order_with_velocity = 3,
                 .source = "Yoshida 1990, table 1, solution A",
                 .step = step_yoshida6,
                 .advance = advance_yoshida6},
      Integrator{
          .name = "yoshida8",
          .title = "composition of fifteen leapfrogs of Yoshida's form",
          .order = 8,
          .imaginary_limit = 3.39323426846414935457,
          .real_limit = 2.0857515973776026656,
          .structure = Structure::symplectic,
          .equations = Equations::second_order,
          .order_with_velocity = 3,
          .source = "Yoshida 1990; weights of Suzuki, Umeno 1993: Hairer, Lubich, Wanner 2006, eq. V.3.11",
          .step = step_yoshida8,
          .advance = advance_yoshida8},
      Integrator{.name = "kahan_li8",
                 .title = "Kahan and Li's composition of seventeen leapfrogs",
                 .order = 8,
                 .imaginary_limit = 3.09643868000073217261,
                 .real_limit = 3.1480752829893173099,
                 .structure = Structure::symplectic,
                 .equations = Equations::second_order,
                 .order_with_velocity = 3,
                 .source = "Kahan, Li 1997, s17odr8a",
                 .step = step_kahan_li8,
                 .advance = advance_kahan_li8},
      Integrator{.name = "pefrl",
                 .title = "position-extended Forest-Ruth-like splitting with four kicks",
                 .order = 4,
                 .imaginary_limit = 2.98944954590672912019,
                 .real_limit = 2.1489198193109690947,
                 .structure = Structure::symplectic,
                 .equations = Equations::second_order,
                 .order_with_velocity = 2,
                 .source = "Omelyan, Mryglod, Folk 2002, eqs. 20 and 22",
                 .step = step_pefrl,
                 .advance = advance_pefrl},
  };
  return kRows;
}

}  // namespace truestep
