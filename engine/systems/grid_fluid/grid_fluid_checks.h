// What members of a scene's flow must agree on, each disagreement with its place.
#pragma once
#include "engine/systems/grid_fluid/grid_fluid_def.h"

namespace truestep::grid_fluid {

inline constexpr double kMostCells = 5e7, kMostParticles = 2e7;
double cell_count(const GridFluidDef& d);
void check_flow(const GridFluidDef& d, const DefTable::Report& report);

}  // namespace truestep::grid_fluid
