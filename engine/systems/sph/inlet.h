// A nozzle that emits liquid (collision/points/nozzle.h), with a density of its own.
#pragma once
#include "engine/collision/points/nozzle.h"
#include "engine/systems/sph/sph_def.h"

namespace truestep::sph {

struct Inlet : Nozzle {
  Inlet(const SphDef& d, const InletDef& e)
      : Nozzle(e, {d.dimension, d.spacing, d.support * d.spacing, norm(d.high - d.low)}),
        ratio(e.density.value_or(d.density) / d.density) {}

  double ratio;  ///< density over the system's
};

}  // namespace truestep::sph
