// The memory of the rows with compensated sums.
#include "engine/integrators/explicit/compensated.h"

#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

size_t compensated_memory(size_t n) {
  return sums_memory(n);
}

void prepare_compensated(const ForceField& field, State& state) {
  prepare_adaptive(field, state);
  add_memory(state,
             sums_memory(state.f64(state.at("position")).size() + state.f64(state.at("velocity")).size()));
}

}  // namespace truestep
