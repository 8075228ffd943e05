// Everything that a system draws of a state.
#pragma once
#include "engine/core/system.h"

namespace truestep::testing {

inline Drawing drawn(const System& system, const State& state, double t = 0) {
  Drawing out;
  system.draw(state, t, Wish::constant | Wish::obstacles | Wish::marks, out);
  return out;
}

}  // namespace truestep::testing
