// Step functions of all methods, for the rows in rows_*.cc. Each advances the state by input.h.
#pragma once
#include "engine/core/equations/integrator.h"
#include "engine/integrators/advance.h"

namespace truestep {

using StepFunction = void(const ForceField&, State&, const StepInput&, const IntegratorOptions&);
using PrepareFunction = void(const ForceField&, State&);
using MemoryFunction = size_t(size_t n);
using RefusalFunction = std::optional<std::string>(const ForceField&);
using IntervalFunction = StabilityInterval(const IntegratorOptions&);
using ObserveFunction = void(const State&, Observables&);

StepFunction step_euler, step_symplectic_euler, step_modified_euler;    // euler.cc
StepFunction step_midpoint, step_heun, step_rk4;                        // runge_kutta.cc
StepFunction step_verlet;                                               // verlet.cc
PrepareFunction prepare_verlet;                                         // verlet.cc
RefusalFunction refuses_general_rates;                                  // verlet.cc
StepFunction step_velocity_verlet, step_leapfrog, step_yoshida4;        // splitting.cc
StepFunction step_yoshida6, step_yoshida8, step_kahan_li8, step_pefrl;  // splitting.cc

PrepareFunction prepare_adaptive;     // field_equations.cc
MemoryFunction compensated_memory;    // compensated.cc
PrepareFunction prepare_compensated;  // compensated.cc
MemoryFunction ias15_memory;          // ias15.cc
PrepareFunction prepare_ias15;        // ias15.cc

AdvanceFunction advance_euler, advance_midpoint, advance_heun, advance_rk4;           // advance_pairs.cc
AdvanceFunction advance_step_doubling, advance_bs32, advance_rkf45;                   // advance_pairs.cc
AdvanceFunction advance_symplectic_euler, advance_velocity_verlet, advance_leapfrog;  // advance_splitting.cc
AdvanceFunction advance_yoshida4, advance_yoshida6, advance_yoshida8;                 // advance_splitting.cc
AdvanceFunction advance_kahan_li8, advance_pefrl;                                     // advance_splitting.cc
AdvanceFunction advance_rkn86, advance_rkn1210;                                       // advance_nystrom.cc
AdvanceFunction advance_ssprk104;                                                     // ssprk104.cc
AdvanceFunction advance_rkc2;                                                         // rkc2.cc
AdvanceFunction advance_ias15;                                                        // ias15.cc
AdvanceFunction advance_dopri5, advance_tsit5, advance_dop853;                        // advance_NAME.cc

StepFunction step_implicit_euler, step_linear_implicit_euler;  // implicit.cc
RefusalFunction refuses_without_jacobian;                      // implicit.cc
PrepareFunction prepare_implicit_euler;                        // implicit.cc
ObserveFunction observe_implicit_euler;                        // implicit.cc

StepFunction step_projective_dynamics;         // projective_dynamics.cc
RefusalFunction refuses_without_bound;         // projective_dynamics.cc
StepFunction step_vertex_block_descent;        // vertex_block_descent.cc
PrepareFunction prepare_vertex_block_descent;  // vertex_block_descent.cc
RefusalFunction refuses_without_point_forces;  // vertex_block_descent.cc

}  // namespace truestep
