// Columns of the state of a heightfield_wave, and the entries of its column of numbers.
#pragma once
#include "engine/core/state/state.h"

namespace truestep::heightfield_wave::columns {

enum Column : State::Column { kDepth, kX, kY };
enum Number : size_t { kFriction, kSubsteps, kCfl, kNumbers };

}  // namespace truestep::heightfield_wave::columns
