#include "engine/geometry/static_tree.h"

#include <algorithm>
#include <numeric>

namespace truestep {

void StaticTree::build(std::span<const Box> boxes) {
  nodes_.clear();
  if (boxes.empty()) return;
  std::vector<uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0u);
  // Ranges still to be built, the leftmost on top; every inner node waits until its end is known.
  struct Range {
    uint32_t begin, end;
  };
  std::vector<Range> todo{{0, static_cast<uint32_t>(boxes.size())}};
  nodes_.reserve(2 * boxes.size() - 1);
  while (!todo.empty()) {
    const auto [begin, end] = todo.back();
    todo.pop_back();
    Box box = Box::nothing(), centers = Box::nothing();
    for (uint32_t k = begin; k < end; ++k) {
      box.cover(boxes[order[k]]);
      centers.cover(boxes[order[k]].center());
    }
    // A subtree of n leaves has 2 n - 1 nodes.
    const auto here = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back({box, here + 2 * (end - begin) - 1, end - begin == 1 ? order[begin] : kInner});
    if (end - begin == 1) continue;
    const Vec3 e = centers.high - centers.low;
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
    const auto key = [&](uint32_t i) {
      const Vec3 c = boxes[i].center();
      return axis == 0 ? c.x : axis == 1 ? c.y : c.z;
    };
    const uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                     [&](uint32_t a, uint32_t b) {
                       const double p = key(a), q = key(b);
                       return p < q || (p == q && a < b);
                     });
    todo.push_back({middle, end});
    todo.push_back({begin, middle});
  }
}

void StaticTree::refit(std::span<const Box> boxes) {
  for (size_t i = nodes_.size(); i-- > 0;) {
    Node& n = nodes_[i];
    if (n.item != kInner) {
      n.box = boxes[n.item];
    } else {
      n.box = nodes_[i + 1].box;
      n.box.cover(nodes_[nodes_[i + 1].skip].box);
    }
  }
}

}  // namespace truestep
