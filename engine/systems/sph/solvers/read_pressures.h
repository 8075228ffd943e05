// The pressure that is read (transmitted.h), with what surface tension transmits.
#pragma once
#include "engine/systems/sph/fluid.h"

namespace truestep::sph {

/// Pa, of all rows of a state; f has its places sorted and listed without walls.
template <int D, class T>
void read_pressures(const Setting& set, Fluid<D, T>& f, const State& s, const ThreadArena& arena,
                    double* out);

}  // namespace truestep::sph
