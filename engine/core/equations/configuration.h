// The numbers that say where a system is: every f64 column of role position, concatenated. Unlike the drawn
// fields they contain nothing derived (trails, copies), so they are what two runs of a scene are compared by.
#pragma once
#include <vector>

#include "engine/core/state/state.h"

namespace truestep {

inline std::vector<double> configuration(const State& state) {
  std::vector<double> out;
  for (State::Column c = 0; c < state.columns(); ++c) {
    if (state.info(c).role != Role::position || state.info(c).type != Scalar::f64) continue;
    const auto values = state.f64(c);
    out.insert(out.end(), values.begin(), values.end());
  }
  return out;
}

}  // namespace truestep
