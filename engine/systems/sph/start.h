// How a liquid starts: its particles on the lattices of its bodies, or at rest. No lattice is a state of
// rest: under their own weight its rows buckle, grains of other lattices grow and meet, and pbf is compressed
// by what its corrections leave. A liquid that settles does all that before time starts, by the solver's own
// steps.
#pragma once
#include "engine/systems/sph/setting.h"

namespace truestep::sph {

/// All particles on their lattices, with hydrostatic densities for wcsph.
State start_of(const Setting& set, const Vec3& gravity);
/// Lets all bodies that do not move at the start, of a state of start_of, settle for the setting's time in
/// steps of dt (s); then they have the velocities of `initial` alone. Error Instability as of a step.
void come_to_rest(const Setting& set, const Vec3& gravity, double dt, State& s);

}  // namespace truestep::sph
