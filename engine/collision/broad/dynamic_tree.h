// Hierarchy of boxes that move: leaves are inserted where the surface of the boxes above them grows least,
// and every ancestor is improved by rotations on the way up (Catto, "Dynamic bounding volume hierarchies",
// GDC 2019). Siblings share one cache line: 2 x (six floats rounded outwards, child, parent). No recursion.
#pragma once
#include <bit>
#include <cstdint>
#include <vector>

#include "engine/geometry/box.h"

namespace truestep {

/// Box in floats that contains the box in doubles from which it was made.
struct FloatBox {
  float low[3], high[3];

  static FloatBox around(const Box& b) {
    return {{below(b.low.x), below(b.low.y), below(b.low.z)},
            {-below(-b.high.x), -below(-b.high.y), -below(-b.high.z)}};
  }
  /// Largest float that is not above x.
  static float below(double x) {
    const auto f = static_cast<float>(x);
    if (static_cast<double>(f) <= x) return f;
    const auto bits = std::bit_cast<uint32_t>(f);
    // One step down: towards zero when positive, away from it when negative; from zero to the first below.
    return std::bit_cast<float>(f > 0 ? bits - 1 : f < 0 ? bits + 1 : 0x80000001u);
  }
  bool overlaps(const FloatBox& b) const {
    return (low[0] <= b.high[0]) & (low[1] <= b.high[1]) & (low[2] <= b.high[2]) & (b.low[0] <= high[0]) &
           (b.low[1] <= high[1]) & (b.low[2] <= high[2]);
  }
  bool contains(const FloatBox& b) const {
    return (low[0] <= b.low[0]) & (low[1] <= b.low[1]) & (low[2] <= b.low[2]) & (b.high[0] <= high[0]) &
           (b.high[1] <= high[1]) & (b.high[2] <= high[2]);
  }
  Box as_box() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }
};

class DynamicTree {
 public:
  /// Adds leaf `id` (any number below 2^31, used once; storage grows to the largest).
  void insert(uint32_t id, const FloatBox& box);
  void remove(uint32_t id);
  bool holds(uint32_t id) const { return id < leaf_.size() && leaf_[id] >= 0; }
  const FloatBox& box(uint32_t id) const { return nodes_[static_cast<size_t>(leaf_[id])].box; }
  void clear();
  /// Adds or changes leaf `id` without placing it in the hierarchy: rebuild() must follow before anything is
  /// inserted, removed or queried by box.
  void set(uint32_t id, const FloatBox& box);
  /// Discards the hierarchy and builds a balanced one over the same leaves: for many moved at once.
  void rebuild();
  size_t size() const { return count_; }
  /// Sum of the inner boxes' surfaces over the root's: roughly the cost of a query.
  double cost() const;

  /// visit(id) for every leaf whose box passes and whose ancestors' boxes pass; passes(const FloatBox&).
  template <class Passes, class Visit>
  void each(Passes&& passes, Visit&& visit) const;
  /// visit(id) for every leaf that overlaps the box.
  template <class Visit>
  void overlapping(const FloatBox& b, Visit&& visit) const {
    each([&b](const FloatBox& n) { return n.overlaps(b); }, visit);
  }

 private:
  struct Node {
    FloatBox box;
    int32_t child;   // first of two siblings side by side; ~id for a leaf
    int32_t parent;  // -1 for the root
  };
  static_assert(sizeof(Node) == 32);

  int32_t best_sibling(const FloatBox& box) const;
  void refit_from(int32_t node);
  void rotate(int32_t node);
  void exchange(int32_t a, int32_t b);
  void adopt(int32_t node);
  int32_t new_pair();

  std::vector<Node> nodes_;     // 0 is the root, pairs begin at even places from 2 on
  std::vector<int32_t> leaf_;   // node of every id, -1 when absent
  std::vector<int32_t> spare_;  // free pairs
  struct Leaf {
    FloatBox box;
    uint32_t id;
  };
  struct Range {
    uint32_t begin, end;
    int32_t node;
  };
  std::vector<Leaf> sorted_;  // of rebuild()
  std::vector<Range> todo_;
  size_t count_ = 0;
};

template <class Passes, class Visit>
void DynamicTree::each(Passes&& passes, Visit&& visit) const {
  if (count_ == 0 || !passes(nodes_[0].box)) return;
  // One pending node per level is all that a depth-first walk needs; deeper trees do not occur (rotations
  // keep them below 3 log2 n), and if one did, the walk would continue in a vector.
  constexpr size_t kDepth = 96;
  int32_t stack[kDepth];
  std::vector<int32_t> overflow;
  size_t top = 0;
  int32_t at = 0;
  for (;;) {
    const Node& n = nodes_[static_cast<size_t>(at)];
    if (n.child < 0) {
      visit(static_cast<uint32_t>(~n.child));
    } else {
      const bool left = passes(nodes_[static_cast<size_t>(n.child)].box);
      const bool right = passes(nodes_[static_cast<size_t>(n.child) + 1].box);
      if (left) {
        if (right) {
          if (top < kDepth) {
            stack[top++] = n.child + 1;
          } else {
            overflow.push_back(n.child + 1);
          }
        }
        at = n.child;
        continue;
      }
      if (right) {
        at = n.child + 1;
        continue;
      }
    }
    if (!overflow.empty()) {
      at = overflow.back();
      overflow.pop_back();
    } else if (top > 0) {
      at = stack[--top];
    } else {
      return;
    }
  }
}

}  // namespace truestep
