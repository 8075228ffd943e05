// The coupling type "ragdoll": the bones of a, a skeleton, carry the bodies of b at their initial poses on
// the bones, with the velocities of the bones (links of an articulation as closely as their joints allow,
// systems/articulation/carried_links.h). At a given time, or when an impact changes a body's velocity in a
// step by more than a threshold, the bodies are released with their present velocities, and the skeleton
// follows them. After a while it may move by itself again: from the pose in which it was left, over a blend,
// into the most similar pose of its own motion (Zordan, Majkowska, Chiu, Fast 2005, "Dynamic response for
// motion capture animation", without their simulated transition).
#pragma once
#include <memory>

#include "engine/core/coupling.h"
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"

namespace truestep::ragdoll {

struct RagdollDef {
  std::vector<int64_t> bones, bodies;
  std::optional<double> at, impact;
  std::vector<int64_t> impact_bodies;
  std::optional<double> back_after;
  double blend = 0.5;
  std::optional<double> match_from, match_to;
};

const DefTable& ragdoll_table();
Cost ragdoll_cost(const void* def, const Cost& a, const Cost& b);
/// Error "scene_invalid" if a is not a skeleton, b has no bodies in space, or an index does not exist.
std::unique_ptr<const Coupling> build_ragdoll(const void* def, const CouplingContext& context);

}  // namespace truestep::ragdoll
