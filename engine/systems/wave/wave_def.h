// What a scene says about waves in a box; see wave.h.
#pragma once
#include "engine/core/def/build.h"
#include "engine/core/outputs.h"
#include "engine/lattice/lattice_def.h"

namespace truestep::wave {

struct WaveDef : lattice::LatticeDef {
  std::string speed = "1";         ///< m/s
  std::string initial_rate = "0";  ///< m/s
  double damping = 0;              ///< 1/s
};

const DefTable& wave_table();
const Outputs& wave_outputs();
Cost wave_cost(const void* def);

}  // namespace truestep::wave
