// Rows of observables; out of line, because every system adds dozens.
#include "engine/core/observables.h"

namespace truestep {

void Observables::add(std::string_view name, double value, std::string_view unit) {
  rows_.push_back({std::string(name), value, std::string(unit)});
}

std::optional<double> Observables::find(std::string_view name) const {
  for (const Observation& o : rows_) {
    if (o.name == name) return o.value;
  }
  return std::nullopt;
}

}  // namespace truestep
