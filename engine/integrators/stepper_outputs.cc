#include "engine/integrators/stepper_outputs.h"

#include "engine/integrators/equation_stepper.h"

namespace truestep {

StepperCounts stepper_counts(const System&, const State& state, double) {
  Observables out;
  EquationStepper::observe(state, out);
  const auto& rows = out.rows();
  return {rows[0].value, rows[1].value, rows[2].value, rows[3].value};
}

}  // namespace truestep
