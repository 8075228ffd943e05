// Bodies that meet within a step: pairs that are apart at its start and move relative to each other so far
// that they would pass. Their time of impact on their motion without contacts gives the contact that the
// solver works with. Which of the two moves does not matter: a shield that hits a ball at rest counts as a
// ball that hits a wall.
#pragma once
#include "engine/systems/rigid2d/pairs.h"

namespace truestep::rigid2d {

/// Marks of Pairs::active.
enum Activity : uint8_t { kStill = 0, kMoves = 1, kMovesFar = 2 };

/// Adds the contacts of bodies that meet within h (s) to `pairs.hits`, in order, and lists them in
/// `pairs.met`. Returns whether a sleeping body is hit; it is then marked in `pairs.seeds`.
bool find_meetings(const Model& model, const State& s, double h, Pairs& pairs);

}  // namespace truestep::rigid2d
