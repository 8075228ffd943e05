// Finds the shapes in contact in a step: broad phase over the boxes of shapes, filters, manifolds, and the
// contacts of the last step that they continue. Sleeping pairs are skipped; a sleeping body that is touched
// wakes.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/collision/broad/broad_phase.h"
#include "engine/collision/flat/contact.h"
#include "engine/systems/rigid2d/columns.h"

namespace truestep::rigid2d {

/// A pair of shapes close to each other.
struct Hit {
  uint32_t a = 0, b = 0;  ///< shapes
  uint32_t body_a = 0, body_b = 0;
  uint32_t old = kNoPoint;  ///< row of this pair's contact in the state
  enum class What : uint8_t { untested, none, touching, carried } what = What::untested;
  uint64_t key() const { return uint64_t{a} << 32 | b; }
};

/// A pair that is apart at the start of the step and meets within it (solver/meetings.h).
struct Met {
  uint64_t key = 0;  ///< of its hit
  Vec2 apart;        ///< m, from the centre of a to that of b when they meet
};

/// Scratch of a step; the next step needs nothing from it.
struct Pairs {
  BroadPhase broad;
  std::vector<Pose> pose;  ///< of every body at the start of the step, the world last
  std::vector<Box> boxes;
  std::vector<Mobility> mobility;
  std::vector<Hit> hits;  ///< all candidates
  /// Of every touching pair: normal in the world, points about the centre of a in world axes.
  std::vector<flat::Contact> contacts;
  std::vector<uint32_t> touching;                        ///< the pairs with contacts to solve, ascending
  std::vector<uint8_t> active, seeds;                    ///< active: see Activity
  std::vector<Met> met;                                  ///< ascending
  std::vector<std::pair<uint32_t, uint32_t>> on_ground;  ///< shapes that touch fixed polygons, and the hits
  std::vector<Vec2> ahead;  ///< motion of every body in this step without contacts, m, bounded
};

/// The meeting of a hit; null if it is none.
inline const Met* meeting(const Pairs& p, uint64_t key) {
  const auto at =
      std::lower_bound(p.met.begin(), p.met.end(), key, [](const Met& m, uint64_t k) { return m.key < k; });
  return at != p.met.end() && at->key == key ? &*at : nullptr;
}

/// Fills `pairs` for this state and wakes sleeping bodies that are touched. h in s.
void find_contacts(const Model& model, State& s, double h, Pairs& pairs, const ThreadArena& arena);

/// True where the contact passes a one-way platform.
bool passes_one_way(const Model& model, const State& s, const Hit& h, const flat::Contact& contact);

/// True where groups, masks, sensors and joints allow the two bodies to touch.
bool may_touch(const Model& model, uint32_t body_a, uint32_t body_b);

}  // namespace truestep::rigid2d
