// Consistency checks between the members of a flow's definition, each error with its pointer.
#pragma once
#include "engine/systems/grid_fluid/grid_fluid_def.h"

namespace truestep::grid_fluid {

inline constexpr double kMostCells = 5e7, kMostParticles = 2e7;
double cell_count(const GridFluidDef& d);
/// What liquids with a surface do not have is refused by name, and so is what only they have.
void check_liquid(const GridFluidDef& d, const DefTable::Report& report);
void check_flow(const GridFluidDef& d, const DefTable::Report& report);

}  // namespace truestep::grid_fluid
