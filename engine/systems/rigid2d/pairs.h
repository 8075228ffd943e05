// Which shapes touch in a step: broad phase over the shapes' boxes, filters, manifolds, and the contacts of
// the last step that they continue. What sleeps is not looked at; what is touched wakes.
#pragma once
#include <vector>

#include "engine/base/parallel.h"
#include "engine/collision/broad/broad_phase.h"
#include "engine/collision/flat/contact.h"
#include "engine/systems/rigid2d/columns.h"

namespace truestep::rigid2d {

/// A pair of shapes near one another.
struct Hit {
  uint32_t a = 0, b = 0;  ///< shapes
  uint32_t body_a = 0, body_b = 0;
  uint32_t old = kNoPoint;  ///< row of the same pair's contact in the state
  enum class What : uint8_t { untested, none, touching, carried } what = What::untested;
  uint64_t key() const { return uint64_t{a} << 32 | b; }
};

/// Scratch of a step; nothing in it matters to the next.
struct Pairs {
  BroadPhase broad;
  std::vector<Pose> pose;  ///< of every body at the step's start, the world last
  std::vector<Box> boxes;
  std::vector<Mobility> mobility;
  std::vector<Hit> hits;  ///< all candidates
  /// Of every hit that touches: normal in the world, points about a's centre, turned into the world.
  std::vector<flat::Contact> contacts;
  std::vector<uint32_t> touching;  ///< those with contacts to solve, ascending
  std::vector<uint8_t> active, seeds;
  std::vector<Vec2> ahead;  ///< of every body: how far it goes in this step if nothing stops it, m, bounded
};

/// Fills `pairs` for this state and wakes what is touched. h in s.
void find_contacts(const Model& model, State& s, double h, Pairs& pairs, const ThreadArena& arena);

/// May these two touch, as far as groups, masks, sensors and joints say?
bool may_touch(const Model& model, uint32_t body_a, uint32_t body_b);

}  // namespace truestep::rigid2d
