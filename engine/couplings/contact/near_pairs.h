// Which points may meet which solids during a substep: pairs whose boxes,
// widened by a margin, overlap. The pairs stay good while every box stays
// within the widened one, so that what answers change is looked up in the list
// and the grid is built once in most substeps.
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
  /// Boxes of all rows' ways; to be filled before find(). Solids' boxes are as wide as they are felt.
  std::vector<Box> points, solids;

  /// The pairs of these boxes, by point; `keep(point, solid)` says which count. May run concurrently.
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
  /// Whether a point or a solid with this box meets only what is listed; if not, its box is made to hold it
  /// and find() is due again.
  bool holds_point(size_t point, const Box& box) { return holds(points[point], box); }
  bool holds_solid(size_t solid, const Box& box) { return holds(solids[solid], box); }

  /// body(block, pairs) for all blocks, concurrently; blocks are numbered by their points.
  template <class Body>
  void each_block(const ThreadArena& arena, Body&& body) const {
    arena.for_blocks(blocks_.size(), 1, [&](size_t begin, size_t) { body(begin, blocks_[begin]); });
  }
  size_t blocks() const { return blocks_.size(); }

 private:
  /// Points that look for solids together: enough to be worth a task, few enough to balance.
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
