// A nozzle that pours a material (collision/points/nozzle.h); particles start behind its mouth at a depth
// equal to their reach, and nodes inside it move at its speed.
#pragma once
#include "engine/collision/points/nozzle.h"
#include "engine/systems/mpm/mpm_def.h"

namespace truestep::mpm {

struct Inlet : Nozzle {
  Inlet(const MpmDef& d, const InletDef& e)
      : Nozzle(e, {d.dimension, d.spacing(), 2 * d.cell, norm(d.high - d.low)}) {}
};

}  // namespace truestep::mpm
