// The end of a step: bodies too fast for the solver's contacts stop at the surface they would have passed,
// and islands at rest fall asleep.
#pragma once
#include "engine/rigid/sleeping.h"
#include "engine/systems/rigid2d/columns.h"
#include "engine/systems/rigid2d/pairs.h"

namespace truestep::rigid2d {

/// How a body moved in the step that ends.
struct Travel {
  uint32_t body = 0;
  Vec2 shift;
  double angle = 0;
};

/// Sets fast bodies back to where they first touch fixed bodies (for a bullet: any body). `travels` lists all
/// bodies that moved, ascending; poses in `pairs` are those at the start of the step.
void stop_fast_bodies(const Model& model, State& s, const Pairs& pairs, std::span<const Travel> travels,
                      double h, const ThreadArena& arena);

/// Scratch of a step.
struct Sleepers {
  std::vector<uint32_t> parent;
  std::vector<double> rested;
  std::vector<uint8_t> unborne, still;  ///< no fixed body supports it; its velocities are zero
  std::vector<uint8_t> holds;           ///< what holds it
};
/// Counts rest times (h in s) and puts supported islands at rest to sleep (rigid/sleeping.h).
void fall_asleep(const Model& model, State& s, const Pairs& pairs, const SleepRule& rule, double h,
                 Sleepers& scratch);

}  // namespace truestep::rigid2d
