// The counters of an EquationStepper as rows of a table of outputs.
#pragma once
#include <array>

#include "engine/core/outputs/outputs_of.h"

namespace truestep {

/// Since the start.
struct StepperCounts {
  double steps, rejected, rates, jacobians;
};
StepperCounts stepper_counts(const System& system, const State& state, double t);

inline constexpr auto kStepperRows = std::to_array<Measured<StepperCounts>>(
    {{"integrator.steps", "1", &StepperCounts::steps, "internal steps taken since the start"},
     {"integrator.rejected", "1", &StepperCounts::rejected, "rejected internal steps"},
     {"integrator.rates", "1", &StepperCounts::rates, "evaluations of the right-hand side"},
     {"integrator.jacobians", "1", &StepperCounts::jacobians, "evaluations of its derivatives"}});

}  // namespace truestep
