// What heat conduction gives out.
#include <algorithm>

#include "engine/core/outputs/outputs_of.h"
#include "engine/integrators/stepper_outputs.h"
#include "engine/lattice/lattice_state.h"
#include "engine/systems/heat/heat.h"

namespace truestep::heat {

struct Heat::Whole {
  double energy, lowest, highest;
  std::optional<double> error;
};

const OutputTable& Heat::outputs() {
  static const OutputTable kTable =
      OutputsOf<Heat>("a node of the lattice, x fastest")
          .part("", [](const Heat& h) { return lattice::grid_part(h.model_.lattice(), {}); })
          .field({"value", "K"}, column(kValue), "temperature")
          .measured(
              &Heat::whole,
              {{"energy.thermal", "J", &Whole::energy, "heat capacity times the integral of the temperature"},
               {"value.min", "K", &Whole::lowest, "lowest temperature"},
               {"value.max", "K", &Whole::highest, "highest temperature"},
               {"error.exact", "K", &Whole::error,
                "difference from the scene's exact solution, root mean square over the box"}})
          .measured(stepper_counts, kStepperRows)
          .build();
  return kTable;
}

const Outputs& heat_outputs() {
  static const Outputs kDescribed = Heat::outputs().described();
  return kDescribed;
}

Heat::Whole Heat::whole(const State& s, double t) const {
  const auto u = s.f64(kValue);
  const auto [low, high] = std::ranges::minmax_element(u);
  return {def_.heat_capacity * lattice::integral(model_.lattice(), u), *low, *high,
          model_.distance_from_exact(u, t)};
}

}  // namespace truestep::heat
