#include "engine/session/remedies.h"

#include <cmath>

#include "engine/base/short_number.h"
#include "engine/core/force_system.h"

namespace truestep {

namespace {

bool unlimited(const Integrator& row, const ForceSystem& s) {
  return std::isinf(stability_interval(row, s.options()).imaginary);
}

// The first method of the wanted kind that serves the field and is not the one that failed.
const Integrator* other_method(const ForceSystem& s, Integrator::Kind kind, Integrator::Stepping stepping) {
  for (const Integrator& row : integrators()) {
    if (&row == &s.integrator() || row.kind != kind || row.stepping != stepping || !row.step) continue;
    if ((kind != Integrator::Kind::implicit || unlimited(row, s)) && !refusal(row, s.force_field()))
      return &row;
  }
  return nullptr;
}

}  // namespace

std::vector<std::string> remedies(const World& world, const std::string& system,
                                  std::optional<double> stable_dt) {
  std::vector<std::string> out = world.system(world.index_of(system)).remedies();
  if (!out.empty()) return out;
  const double dt = world.dt();
  const int64_t substeps = world.scene().header.time.substeps;
  constexpr double kMostParts = 1e9;  // beyond that (a state that has exploded) no step is advice
  if (stable_dt && *stable_dt < dt && dt < kMostParts * *stable_dt) {
    const auto parts = static_cast<int64_t>(std::ceil(dt / *stable_dt)) * substeps;
    out.push_back("a step of at most " + short_number(*stable_dt, 2) + " s, or " + std::to_string(parts) +
                  " substeps of the present one");
  } else {
    out.push_back("half the step, or " + std::to_string(2 * substeps) + " substeps of the present one");
  }
  const auto* forces = dynamic_cast<const ForceSystem*>(&world.system(world.index_of(system)));
  const Integrator* method = nullptr;
  if (forces) {
    using Kind = Integrator::Kind;
    using Stepping = Integrator::Stepping;
    const Integrator& own = forces->integrator();
    method = own.kind == Kind::implicit && unlimited(own, *forces)
                 ? nullptr
                 : other_method(*forces, Kind::implicit, Stepping::fixed);
    if (!method) method = other_method(*forces, Kind::explicit_, Stepping::adaptive);
  }
  if (method) {
    out.push_back(
        "the integrator " + std::string(method->name) + " (" + std::string(method->title) + "), which " +
        (method->kind == Integrator::Kind::implicit ? "holds at any step" : "chooses its own steps"));
  } else {
    out.push_back("softer forces: lower stiffness, more mass or more damping");
  }
  return out;
}

}  // namespace truestep
