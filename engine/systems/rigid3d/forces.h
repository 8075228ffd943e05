// Velocity changes of bodies by gravity, pushes and drags in one step, for any solver.
#pragma once
#include <span>
#include <vector>

#include "engine/systems/rigid3d/rigid3d_state.h"

namespace truestep::rigid3d {

/// Change of velocity (m/s) in h (s), one per row. Wakes pushed or dragged bodies and reduces the remaining
/// time of pushes. `twist` is the change of angular momentum (N m s, in the world) of every row by constant
/// torques, empty if there are none.
void collect_forces(State& s, std::span<const BodyKind> kinds, double h, std::vector<Vec3>& change,
                    std::vector<Vec3>& twist);

}  // namespace truestep::rigid3d
