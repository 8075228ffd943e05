// Step functions of all methods, for the table in integrators.cc. Each advances the state by input.h.
#pragma once
#include "engine/core/integrator.h"

namespace truestep {

using StepFunction = void(const ForceField&, State&, const StepInput&, const IntegratorOptions&);
using PrepareFunction = void(const ForceField&, State&);
using RefusalFunction = std::optional<std::string>(const ForceField&);

StepFunction step_euler, step_symplectic_euler, step_modified_euler;  // euler.cc
StepFunction step_midpoint, step_heun, step_rk4;                      // runge_kutta.cc
StepFunction step_verlet;                                             // verlet.cc
PrepareFunction prepare_verlet;                                       // verlet.cc
RefusalFunction refuses_general_rates;                                // verlet.cc
StepFunction step_velocity_verlet, step_leapfrog, step_yoshida4;      // splitting.cc

StepFunction step_step_doubling, step_dopri5;  // adaptive.cc
PrepareFunction prepare_adaptive;              // adaptive.cc

StepFunction step_implicit_euler, step_linear_implicit_euler;  // implicit.cc
RefusalFunction refuses_without_jacobian;                      // implicit.cc

}  // namespace truestep
