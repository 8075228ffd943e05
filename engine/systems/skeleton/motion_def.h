// Tables of recorded motions: files, markers, layers of them, and priors learnt from them.
#pragma once
#include "engine/systems/skeleton/skeleton_def.h"

namespace truestep::skeleton {

inline constexpr size_t kMostJoints = 10'000;

const DefTable& motion_table();
const DefTable& layer_table();
const DefTable& prior_table();

}  // namespace truestep::skeleton
