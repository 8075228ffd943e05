// What ends a step: bodies too fast for the solver's contacts stop at what they would have passed, and what
// has come to rest falls asleep, island by island.
#pragma once
#include "engine/systems/rigid2d/columns.h"
#include "engine/systems/rigid2d/pairs.h"

namespace truestep::rigid2d {

/// How a body moved in the step that ends.
struct Travel {
  uint32_t body = 0;
  Vec2 shift;
  double angle = 0;
};

/// Takes fast bodies back to where they first touch fixed bodies (a bullet: any body). `travels` are all that
/// moved, ascending; poses in `pairs` are those at the step's start.
void stop_fast_bodies(const Model& model, State& s, const Pairs& pairs, std::span<const Travel> travels,
                      double h, const ThreadArena& arena);

struct SleepRule {
  double speed = 0.05, time = 0.5;  ///< m/s, s
};
/// Counts rest (h in s) and puts islands to sleep whose bodies have all rested long enough.
void fall_asleep(const Model& model, State& s, const Pairs& pairs, const SleepRule& rule, double h,
                 std::vector<uint32_t>& parent, std::vector<double>& rest);

}  // namespace truestep::rigid2d
