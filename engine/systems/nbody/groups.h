// Bodies by rules: star clusters, balls, disk galaxies, rings and orbits. What is random is a function of the
// seed, the group and the body's number alone.
#pragma once
#include <vector>

#include "engine/systems/nbody/nbody_def.h"
#include "engine/systems/nbody/nbody_state.h"

namespace truestep::nbody {

/// All bodies of the def at t = 0, in the order of their rows.
std::vector<Body> bodies_at_start(const NbodyDef& def, uint64_t seed);

}  // namespace truestep::nbody
