// What waves give out.
#include <algorithm>

#include "engine/core/outputs/outputs_of.h"
#include "engine/integrators/stepper_outputs.h"
#include "engine/lattice/lattice_state.h"
#include "engine/systems/wave/wave.h"

namespace truestep::wave {

struct Wave::Whole {
  double kinetic, potential, total, lowest, highest;
  std::optional<double> error;
};

const OutputTable& Wave::outputs() {
  constexpr auto kDeviation = FieldInfo::Scale::deviation;
  static const OutputTable kTable =
      OutputsOf<Wave>("a node of the lattice, x fastest")
          .part("", [](const Wave& w) { return lattice::grid_part(w.model_.lattice(), {}); })
          .field({"value", "m", Scalar::f64, 1, Meaning::value, kDeviation}, column(kValue), "displacement")
          .field({"rate", "m/s", Scalar::f64, 1, Meaning::value, kDeviation}, column(kRate),
                 "its rate of change")
          .measured(&Wave::whole,
                    {{"energy.kinetic", "J", &Whole::kinetic, "half the integral of the squared rate"},
                     {"energy.potential", "J", &Whole::potential,
                      "half the integral of the squared speed times slope"},
                     {"energy.total", "J", &Whole::total, "their sum"},
                     {"value.min", "m", &Whole::lowest, "lowest displacement"},
                     {"value.max", "m", &Whole::highest, "highest displacement"},
                     {"error.exact", "m", &Whole::error,
                      "difference from the scene's exact solution, root mean square over the box"}})
          .measured(stepper_counts, kStepperRows)
          .build();
  return kTable;
}

const Outputs& wave_outputs() {
  static const Outputs kDescribed = Wave::outputs().described();
  return kDescribed;
}

Wave::Whole Wave::whole(const State& s, double t) const {
  static const ThreadArena kSerial(1);
  Workspace workspace;
  const Energy e = *energy(s, t, workspace, kSerial);
  const auto u = s.f64(kValue);
  const auto [low, high] = std::ranges::minmax_element(u);
  return {e.kinetic, e.potential, e.kinetic + e.potential, *low, *high, model_.distance_from_exact(u, t)};
}

}  // namespace truestep::wave
