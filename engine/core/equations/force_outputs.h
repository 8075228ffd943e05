// Passes over a state that every system of forces may list in its table of outputs (core/outputs/).
#pragma once
#include <array>
#include <optional>

#include "engine/core/equations/force_system.h"
#include "engine/core/outputs/outputs_of.h"

namespace truestep {

/// J; without a potential there is no total.
struct ForceEnergies {
  double kinetic = 0;
  std::optional<double> potential = {}, total = {};
};
ForceEnergies force_energies(const ForceSystem& system, const State& state, double t);

/// What implicit_euler counts; empty with any other method.
struct HeldSteps {
  std::optional<double> count;
};
HeldSteps held_steps(const ForceSystem& system, const State& state, double t);

/// The rows of these passes where a system has nothing more to say of them.
inline constexpr auto kForceEnergyRows = std::to_array<Measured<ForceEnergies>>(
    {{"energy.kinetic", "J", &ForceEnergies::kinetic, "of motion"},
     {"energy.potential", "J", &ForceEnergies::potential, "of all conservative forces"},
     {"energy.total", "J", &ForceEnergies::total, "their sum"}});
inline constexpr auto kHeldStepsRows =
    std::to_array<Measured<HeldSteps>>({{"integrator.held_steps", "1", &HeldSteps::count,
                                         "implicit_euler: steps that used the damping of the step's start"}});

}  // namespace truestep
