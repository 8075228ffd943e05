// Advance functions of the implicit methods, for the rows in rows_*.cc.
#pragma once
#include "engine/integrators/advance.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

AdvanceFunction advance_rodas5p;                               // rosenbrock.cc
AdvanceFunction advance_radau5;                                // radau5.cc
AdvanceFunction advance_sdirk4, advance_tr_bdf2;               // sdirk.cc
AdvanceFunction advance_tr_bdf2_fixed;                         // sdirk.cc: without error control
AdvanceFunction advance_implicit_midpoint, advance_trapezoid;  // sdirk.cc
AdvanceFunction advance_implicit_euler;                        // sdirk.cc
AdvanceFunction advance_linear_implicit_euler;                 // linear_euler.cc
AdvanceFunction advance_bdf2;                                  // bdf2.cc
PrepareFunction prepare_bdf2;                                  // bdf2.cc
MemoryFunction bdf2_memory, generalized_alpha_memory;          // bdf2.cc, newmark.cc
AdvanceFunction advance_newmark, advance_generalized_alpha;    // newmark.cc
PrepareFunction prepare_generalized_alpha;                     // newmark.cc
RefusalFunction refuses_first_order;                           // newmark.cc
IntervalFunction newmark_interval;                             // newmark.cc
AdvanceFunction advance_cvode_bdf, advance_cvode_adams;        // cvode.cc
PrepareFunction prepare_cvode;                                 // cvode.cc
MemoryFunction cvode_memory;                                   // cvode.cc

/// Adds the column "integrator.memory" of n numbers, nothing in it yet.
void add_memory(State& state, size_t n);

}  // namespace truestep
