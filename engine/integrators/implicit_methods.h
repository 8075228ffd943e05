// Advance functions of the implicit methods, for the table in integrators.cc.
#pragma once
#include "engine/integrators/advance.h"

namespace truestep {

AdvanceFunction advance_rodas5p;                                                      // rosenbrock.cc
AdvanceFunction advance_radau5;                                                       // radau5.cc
AdvanceFunction advance_sdirk4, advance_tr_bdf2;                                      // sdirk.cc
AdvanceFunction advance_implicit_midpoint, advance_trapezoid;                         // sdirk.cc
AdvanceFunction advance_cvode_bdf, advance_cvode_adams;  // cvode.cc

}  // namespace truestep
