// Vorticity confinement (Fedkiw, Stam & Jensen 2001, for particles as by Macklin & Mueller 2013): eddies that
// averaging over particles damps are driven, along N x omega with N towards larger vorticity.
#pragma once
#include "engine/systems/sph/fluid.h"

namespace truestep::sph {

/// v += h strength spacing N x omega.
template <int D, class T>
void confine_vorticity(Fluid<D, T>& f, T strength, T spacing, T h, const ThreadArena& arena);

}  // namespace truestep::sph
