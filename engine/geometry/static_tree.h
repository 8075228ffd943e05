// Hierarchy of boxes that is built once, for triangles of a mesh and parts of a compound. Built by halving
// at the median of centres along the longest side, so depth is log2(n); nodes in depth-first order, the left
// child follows its parent.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/box.h"

namespace truestep {

class StaticTree {
 public:
  void build(std::span<const Box> boxes);
  /// Replaces the boxes, keeping the hierarchy: for a surface that moves but stays in one piece.
  void refit(std::span<const Box> boxes);
  bool empty() const { return nodes_.empty(); }
  /// Around everything; the empty box when there is nothing.
  Box bounds() const { return nodes_.empty() ? Box::nothing() : nodes_[0].box; }

  /// visit(index) for every box that overlaps `b`, in an order that depends on the tree alone.
  template <class Visit>
  void overlapping(const Box& b, Visit&& visit) const {
    each([&](const Box& n) { return n.overlaps(b); }, visit);
  }
  /// visit(index) for every box that passes and whose ancestors' boxes pass.
  template <class Passes, class Visit>
  void each(Passes&& passes, Visit&& visit) const {
    // Skipping to the next node outside a failed subtree needs no stack.
    for (uint32_t i = 0; i < nodes_.size();) {
      const Node& n = nodes_[i];
      if (!passes(n.box)) {
        i = n.skip;
      } else {
        if (n.item != kInner) visit(n.item);
        ++i;
      }
    }
  }

 private:
  static constexpr uint32_t kInner = 0xffffffff;
  struct Node {
    Box box;
    uint32_t skip;  // first node after this subtree
    uint32_t item;  // kInner, or which box
  };
  std::vector<Node> nodes_;
};

}  // namespace truestep
