// Which points may meet which solids during a substep: pairs whose boxes, widened by a margin, overlap. The
// pairs remain valid while every box stays within its widened one, so paths changed by answers are looked up
// in the list, and most substeps build the grid only once.
#pragma once
#include <vector>

#include "engine/base/parallel.h"
#include "engine/collision/broad/box_grid.h"

namespace truestep::contact {

struct NearPair {
  uint32_t point, solid;
};

class NearPairs {
 public:
  /// Boxes around all rows' paths, to be filled before find(). Solids' boxes include their reach.
  std::vector<Box> points, solids;

  /// The pairs of these boxes, by point; `keep(point, solid)` filters them. May run concurrently.
  template <class Keep>
  void find(const ThreadArena& arena, Keep&& keep) {
    widen();
    grid_.build(solids);
    blocks_.resize((points.size() + kBlock - 1) / kBlock);
    arena.for_blocks(points.size(), kBlock, [&](size_t begin, size_t end) {
      std::vector<NearPair>& found = blocks_[begin / kBlock];
      found.clear();
      for (size_t i = begin; i < end; ++i) {
        const auto point = static_cast<uint32_t>(i);
        grid_.overlapping(points[i], [&](uint32_t solid) {
          if (keep(point, solid)) found.push_back({point, solid});
        });
      }
    });
  }
  /// Whether a point or solid with this box meets only listed pairs; if not, its box is enlarged and find()
  /// must run again.
  bool holds_point(size_t point, const Box& box) { return holds(points[point], box); }
  bool holds_solid(size_t solid, const Box& box) { return holds(solids[solid], box); }

  /// body(block, pairs) for all blocks, concurrently; blocks are ordered by point.
  template <class Body>
  void each_block(const ThreadArena& arena, Body&& body) const {
    arena.for_blocks(blocks_.size(), 1, [&](size_t begin, size_t) { body(begin, blocks_[begin]); });
  }
  size_t blocks() const { return blocks_.size(); }

 private:
  /// Points per block of the search: enough to be worth a task, few enough to balance.
  static constexpr size_t kBlock = 1024;

  void widen();
  static bool holds(Box& held, const Box& box) {
    if (held.contains(box)) return true;
    held.cover(box);
    return false;
  }

  BoxGrid grid_;
  std::vector<std::vector<NearPair>> blocks_;
};

}  // namespace truestep::contact
