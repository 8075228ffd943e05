// Names in a scene's header that can be checked only against built systems: fields and rows of probes, fields
// of recordings, observables, quantities of expectations.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/base/errors.h"
#include "engine/core/coupling.h"
#include "engine/core/observables.h"
#include "engine/core/system.h"
#include "engine/scene/scene.h"
#include "engine/session/world/part_table.h"

namespace truestep {

/// A scene's systems and couplings, in order; null where one could not be built.
struct BuiltScene {
  const Scene& scene;
  std::span<const std::unique_ptr<const System>> systems;
  std::span<const std::unique_ptr<const Coupling>> couplings;
  std::span<const std::string> lost_ids;  ///< of systems left out of the scene because their type is unknown
};

/// Everything that a run can observe, with the values at t = 0; NaN where a value appears later (the row of a
/// probe that an emitter has yet to fill).
std::vector<Observation> known_observables(const BuiltScene& parts);

/// The sums over all systems ("energy.total"), then every system's and coupling's own observables; parts that
/// are not built contribute nothing, and a sum is given only when every system knows its part.
Observables observe_parts(const BuiltScene& parts, std::span<const State> systems,
                          std::span<const State> couplings, double t, const WantedObservables& wanted);

/// The existing fields that a probe reads, in the order of the parts.
std::vector<std::string> probed_fields(const PartTable& parts, const ProbeParams& probe);

/// Whether an entry of "observables" selects this name: it equals the name or a prefix of it up to a dot.
bool selects(std::string_view entry, std::string_view name);

/// The fault of an entry of "observables" that selects nothing, or empty.
std::optional<Issue> unknown_observable(const std::string& entry, const std::string& pointer,
                                        std::span<const Observation> known);

/// Appends the faults of the header's names. Parts that are not built are not judged.
void check_references(const BuiltScene& parts, std::vector<Issue>& issues);

}  // namespace truestep
