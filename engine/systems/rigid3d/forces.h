// What gravity, pushes and drags do to the velocities of bodies in one step, whoever solves it.
#pragma once
#include <span>
#include <vector>

#include "engine/systems/rigid3d/rigid3d_state.h"

namespace truestep {

/// Change of velocity (m/s) in h (s), one per row. Wakes what is pushed or dragged and uses up the pushes'
/// time.
void collect_forces(State& s, std::span<const BodyKind> kinds, double h, std::vector<Vec3>& change);

}  // namespace truestep
