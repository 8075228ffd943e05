// Whether a flow that a scene steps in time is one that becomes steady: viscous, in the plane, in a closed
// box whose walls slide at constant speed, at Reynolds numbers at which such flows shed no eddies (a square
// cavity's first oscillates at 8,000; Auteri, Parolini, Quartapelle 2002; longer boxes and two lids earlier).
#pragma once
#include <string>

#include "engine/systems/grid_fluid/grid_fluid_def.h"

namespace truestep::grid_fluid {

/// For the plan: what finds the steady state at once; empty for other flows.
std::string steady_offer(const GridFluidDef& def);

}  // namespace truestep::grid_fluid
