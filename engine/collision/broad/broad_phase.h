// Pairs of bodies that may touch: all pairs of overlapping boxes, sorted. Two dynamic trees (fixed, moving)
// hold the boxes, grown by a margin and extended ahead of moving bodies, so that most bodies cost one
// comparison; pairs of grown boxes are kept and tested against the true boxes at every update. The result is
// a function of the given boxes, never of earlier updates: the object may be discarded between any two steps.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/collision/broad/dynamic_tree.h"

namespace truestep {

/// Two bodies, a < b.
struct BodyPair {
  uint32_t a = 0, b = 0;
  friend constexpr bool operator==(const BodyPair&, const BodyPair&) = default;
};

/// Fixed bodies are not tested against one another.
enum class Mobility : uint8_t { fixed, moving };

class BroadPhase {
 public:
  /// All pairs i < j, not both fixed, whose boxes overlap (after rounding outwards to floats), ascending. A
  /// box with low > high (Box::nothing()) stands for no body; an infinite one meets everything it overlaps.
  /// `margin` (m): how far a body may move before it is sorted in again; changes speed only. The span is
  /// valid until the next update. No allocation once sizes have settled.
  std::span<const BodyPair> update(std::span<const Box> boxes, std::span<const Mobility> mobility,
                                   double margin);

  /// visit(body) for every body whose grown box overlaps `b`, in no particular but reproducible order.
  template <class Visit>
  void overlapping(const Box& b, Visit&& visit) const {
    const FloatBox f = FloatBox::around(b);
    for (const uint32_t i : unbounded_) visit(i);
    for (const DynamicTree& t : trees_) t.overlapping(f, visit);
  }
  /// The same among the fixed or the moving bodies only, without unbounded ones.
  template <class Visit>
  void overlapping(const Box& b, Mobility which, Visit&& visit) const {
    trees_[static_cast<size_t>(which)].overlapping(FloatBox::around(b), visit);
  }
  /// visit(body) for every body whose grown box passes; passes(const FloatBox&) may become stricter as hits
  /// are found.
  template <class Passes, class Visit>
  void each(Passes&& passes, Visit&& visit) const {
    for (const uint32_t i : unbounded_) visit(i);
    for (const DynamicTree& t : trees_) t.each(passes, visit);
  }

 private:
  void sort_in(std::span<const Box> boxes, std::span<const Mobility> mobility, double margin);
  void renew_candidates(std::span<const Mobility> mobility);
  void test_candidates(std::span<const Mobility> mobility);
  DynamicTree& tree(Mobility m) { return trees_[static_cast<size_t>(m)]; }

  DynamicTree trees_[2];
  std::vector<FloatBox> tight_;
  std::vector<uint8_t> moved_;  // per body: sorted in again by this update
  std::vector<uint32_t> moved_list_, unbounded_;
  struct Left {
    uint32_t body;
    FloatBox box;  // of the last update
  };
  std::vector<Left> left_;            // bodies that left their grown boxes, ascending
  std::vector<uint64_t> candidates_;  // (a << 32 | b), grown boxes overlap, ascending
  std::vector<uint64_t> fresh_, merged_;
  std::vector<BodyPair> pairs_;
};

}  // namespace truestep
