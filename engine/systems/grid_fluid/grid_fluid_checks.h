// Consistency checks between the members of a flow's definition, each error with its pointer.
#pragma once
#include "engine/systems/grid_fluid/grid_fluid_def.h"

namespace truestep::grid_fluid {

inline constexpr double kMostCells = 5e7, kMostParticles = 2e7;
double cell_count(const GridFluidDef& d);
/// Refuses by name what liquids with a surface do not have, and for other flows what only liquids have.
void check_liquid(const GridFluidDef& d, const DefTable::Report& report);
void check_flow(const GridFluidDef& d, const DefTable::Report& report);

}  // namespace truestep::grid_fluid
