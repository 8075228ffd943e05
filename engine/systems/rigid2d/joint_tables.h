// Parameter tables of the joints in the plane, with units and bounds.
#pragma once
#include "engine/systems/rigid2d/rigid2d_def.h"

namespace truestep::rigid2d {

inline constexpr int64_t kMostBodies = 1'000'000;

const DefTable& revolute_table();
const DefTable& prismatic_table();
const DefTable& wheel_table();
const DefTable& distance_table();
const DefTable& spring_table();
const DefTable& weld_table();
const DefTable& motor_table();
const DefTable& mouse_table();
const DefTable& gear_table();
const DefTable& pulley_table();

}  // namespace truestep::rigid2d
