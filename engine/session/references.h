// Names in a scene's header that only built systems can judge: fields and rows of probes, fields of
// recordings, observables, quantities of expectations.
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
#include "engine/session/part_table.h"

namespace truestep {

/// A scene's systems and couplings in its order; null where one could not be built.
struct BuiltScene {
  const Scene& scene;
  std::span<const std::unique_ptr<const System>> systems;
  std::span<const std::unique_ptr<const Coupling>> couplings;
  std::span<const std::string> lost_ids;  ///< of systems that the scene lacks because nobody knows their type
};

/// Everything that a run can observe, with the values at t = 0; NaN where a value comes later (the row of a
/// probe that an emitter has yet to fill).
std::vector<Observation> known_observables(const BuiltScene& parts);

/// The sums over all systems ("energy.total"), then every system's and coupling's own observables; parts that
/// are not built say nothing, and a sum is given only when every system knows its part.
Observables observe_parts(const BuiltScene& parts, std::span<const State> systems,
                          std::span<const State> couplings, double t);

/// The fields that a probe looks at and that there are, in the order of the parts.
std::vector<std::string> probed_fields(const PartTable& parts, const ProbeParams& probe);

/// Whether an entry of "observables" means this name: it is the name or its beginning up to a dot.
bool selects(std::string_view entry, std::string_view name);

/// Fault of an entry of "observables" that selects none of these, or nothing.
std::optional<Issue> unknown_observable(const std::string& entry, const std::string& pointer,
                                        std::span<const Observation> known);

/// Appends what is wrong with the header's names. Of parts that are not built nothing is said.
void check_references(const BuiltScene& parts, std::vector<Issue>& issues);

}  // namespace truestep
