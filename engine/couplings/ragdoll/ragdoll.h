// The coupling type "ragdoll": bodies of b are carried by bones of a, a skeleton, in the place that they have
// on them at t = 0, with the velocities of their bones (links of an articulation as near as their joints let
// them, systems/articulation/carried_links.h). At a time, or when something hits a body so that its
// velocity changes in a step by more than a threshold, they are let go with the velocities that they have
// then, and the skeleton follows them. After a while it may move by itself again: from the pose that it was
// left in, over a blend, on from the most alike pose of its own motion (Zordan, Majkowska, Chiu, Fast 2005,
// "Dynamic response for motion capture animation", without their simulated way there).
#pragma once
#include <memory>

#include "engine/core/build.h"
#include "engine/core/coupling.h"
#include "engine/core/def.h"

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
/// Error "scene_invalid" when a is not a skeleton, b has no bodies in space, or a number is not one of
/// theirs.
std::unique_ptr<const Coupling> build_ragdoll(const void* def, const CouplingContext& context);

}  // namespace truestep::ragdoll
