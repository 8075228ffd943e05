#include "engine/core/observables.h"

namespace truestep {

Observables::Observables() = default;
Observables::Observables(WantedObservables wanted) : wanted_(std::move(wanted)) {}
Observables::~Observables() = default;
Observables::Observables(const Observables&) = default;
Observables::Observables(Observables&&) noexcept = default;
Observables& Observables::operator=(const Observables&) = default;
Observables& Observables::operator=(Observables&&) noexcept = default;

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
