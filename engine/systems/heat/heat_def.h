// What a scene says about heat conduction in a box; see heat.h.
#pragma once
#include "engine/core/def/build.h"
#include "engine/core/outputs.h"
#include "engine/lattice/lattice_def.h"

namespace truestep::heat {

struct HeatDef : lattice::LatticeDef {
  std::string diffusivity = "1";  ///< m^2/s
  double heat_capacity = 1;       ///< J/(m^d K)
};

const DefTable& heat_table();
const Outputs& heat_outputs();
Cost heat_cost(const void* def);

}  // namespace truestep::heat
