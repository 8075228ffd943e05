#include "engine/collision/broad/dynamic_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace truestep {
namespace {

float area(const FloatBox& b) {
  const float x = b.high[0] - b.low[0], y = b.high[1] - b.low[1], z = b.high[2] - b.low[2];
  return x * y + y * z + z * x;
}

FloatBox both(const FloatBox& a, const FloatBox& b) {
  FloatBox r;
  for (int k = 0; k < 3; ++k) {
    r.low[k] = a.low[k] < b.low[k] ? a.low[k] : b.low[k];
    r.high[k] = a.high[k] > b.high[k] ? a.high[k] : b.high[k];
  }
  return r;
}

}  // namespace

void DynamicTree::clear() {
  nodes_.clear();
  leaf_.clear();
  spare_.clear();
  count_ = 0;
}

int32_t DynamicTree::new_pair() {
  if (!spare_.empty()) {
    const int32_t p = spare_.back();
    spare_.pop_back();
    return p;
  }
  const auto p = static_cast<int32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  return p;
}

/// Updates the links to a moved node in its leaf or children.
void DynamicTree::adopt(int32_t node) {
  const int32_t child = nodes_[static_cast<size_t>(node)].child;
  if (child < 0) {
    leaf_[static_cast<size_t>(~child)] = node;
  } else {
    nodes_[static_cast<size_t>(child)].parent = nodes_[static_cast<size_t>(child) + 1].parent = node;
  }
}

/// Greedy descent: stops when making a new parent here costs less than any option further down.
int32_t DynamicTree::best_sibling(const FloatBox& box) const {
  const float own = area(box);
  int32_t at = 0, best = 0;
  float here = area(nodes_[0].box), direct = area(both(nodes_[0].box, box)), inherited = 0;
  float best_cost = direct;
  while (nodes_[static_cast<size_t>(at)].child >= 0) {
    const int32_t child = nodes_[static_cast<size_t>(at)].child;
    if (direct + inherited < best_cost) best = at, best_cost = direct + inherited;
    inherited += direct - here;
    float lower[2], joined[2], size[2];
    for (int k = 0; k < 2; ++k) {
      const Node& n = nodes_[static_cast<size_t>(child + k)];
      joined[k] = area(both(n.box, box));
      size[k] = area(n.box);
      if (n.child < 0) {
        const float cost = joined[k] + inherited;
        if (cost < best_cost) best = child + k, best_cost = cost;
        lower[k] = std::numeric_limits<float>::infinity();
      } else {
        lower[k] = inherited + joined[k] + std::min(own - size[k], 0.0f);
      }
    }
    if (best_cost <= lower[0] && best_cost <= lower[1]) break;
    const int k = lower[1] < lower[0] ? 1 : 0;
    at = child + k, here = size[k], direct = joined[k];
  }
  return best;
}

void DynamicTree::insert(uint32_t id, const FloatBox& box) {
  if (id >= leaf_.size()) leaf_.resize(id + 1, -1);
  if (nodes_.empty()) nodes_.resize(2);
  if (count_++ == 0) {
    nodes_[0] = {box, ~static_cast<int32_t>(id), -1};
    leaf_[id] = 0;
    return;
  }
  // The sibling's place becomes the new parent; sibling and leaf move into a pair below it.
  const int32_t place = best_sibling(box), pair = new_pair();
  Node& parent = nodes_[static_cast<size_t>(place)];
  nodes_[static_cast<size_t>(pair)] = parent;
  nodes_[static_cast<size_t>(pair)].parent = place;
  nodes_[static_cast<size_t>(pair) + 1] = {box, ~static_cast<int32_t>(id), place};
  adopt(pair);
  leaf_[id] = pair + 1;
  parent.child = pair;
  refit_from(place);
}

void DynamicTree::remove(uint32_t id) {
  const int32_t node = leaf_[id];
  leaf_[id] = -1;
  if (--count_ == 0) {
    nodes_.clear();
    spare_.clear();
    return;
  }
  const int32_t parent = nodes_[static_cast<size_t>(node)].parent,
                up = nodes_[static_cast<size_t>(parent)].parent;
  const int32_t pair = node & ~1, sibling = node ^ 1;
  nodes_[static_cast<size_t>(parent)] = nodes_[static_cast<size_t>(sibling)];
  nodes_[static_cast<size_t>(parent)].parent = up;
  adopt(parent);
  spare_.push_back(pair);
  if (up >= 0) refit_from(up);
}

void DynamicTree::refit_from(int32_t node) {
  for (; node >= 0; node = nodes_[static_cast<size_t>(node)].parent) {
    Node& n = nodes_[static_cast<size_t>(node)];
    n.box = both(nodes_[static_cast<size_t>(n.child)].box, nodes_[static_cast<size_t>(n.child) + 1].box);
    rotate(node);
  }
}

/// Swaps two nodes that are not above one another, subtrees and all.
void DynamicTree::exchange(int32_t a, int32_t b) {
  Node &x = nodes_[static_cast<size_t>(a)], &y = nodes_[static_cast<size_t>(b)];
  std::swap(x.box, y.box);
  std::swap(x.child, y.child);
  adopt(a);
  adopt(b);
}

/// Exchanges a child with a grandchild on the other side where that shrinks the other child most.
void DynamicTree::rotate(int32_t node) {
  const int32_t child = nodes_[static_cast<size_t>(node)].child;
  float best = 0;
  int32_t from = -1, to = -1;
  for (int32_t k = 0; k < 2; ++k) {
    const Node &near = nodes_[static_cast<size_t>(child + k)],
               &far = nodes_[static_cast<size_t>(child + 1 - k)];
    if (far.child < 0) continue;
    const float size = area(far.box);
    for (int32_t g = 0; g < 2; ++g) {
      // near replaces the grandchild g, which becomes a child.
      const float gain = size - area(both(near.box, nodes_[static_cast<size_t>(far.child + 1 - g)].box));
      if (gain > best) best = gain, from = child + k, to = far.child + g;
    }
  }
  if (from < 0) return;
  exchange(from, to);
  Node& lower = nodes_[static_cast<size_t>(from ^ 1)];
  lower.box =
      both(nodes_[static_cast<size_t>(lower.child)].box, nodes_[static_cast<size_t>(lower.child) + 1].box);
}

double DynamicTree::cost() const {
  if (count_ < 2) return 0;
  double sum = 0;
  each([](const FloatBox&) { return true; },
       [&](uint32_t id) {
         // Every inner node is the parent of one left child: count parents from their first leaf upwards
         // once.
         for (int32_t n = leaf_[id]; n > 0; n = nodes_[static_cast<size_t>(n)].parent) {
           if (n & 1) break;
           sum += area(nodes_[static_cast<size_t>(nodes_[static_cast<size_t>(n)].parent)].box);
         }
       });
  return sum / area(nodes_[0].box);
}

void DynamicTree::set(uint32_t id, const FloatBox& box) {
  if (id >= leaf_.size()) leaf_.resize(id + 1, -1);
  if (leaf_[id] < 0) {
    if (nodes_.empty()) nodes_.resize(2);
    leaf_[id] = new_pair();
    ++count_;
  }
  nodes_[static_cast<size_t>(leaf_[id])] = {box, ~static_cast<int32_t>(id), -1};
}

void DynamicTree::rebuild() {
  std::vector<Leaf>& leaves = sorted_;
  leaves.clear();
  for (uint32_t id = 0; id < leaf_.size(); ++id) {
    if (leaf_[id] >= 0) leaves.push_back({box(id), id});
  }
  if (leaves.empty()) return;
  nodes_.assign(2, Node{});
  spare_.clear();
  nodes_.reserve(2 * leaves.size() + 2);
  std::vector<Range>& todo = todo_;
  todo.assign(1, {0, static_cast<uint32_t>(leaves.size()), 0});
  nodes_[0].parent = -1;
  while (!todo.empty()) {
    const auto [begin, end, node] = todo.back();
    todo.pop_back();
    if (end - begin == 1) {
      nodes_[static_cast<size_t>(node)].box = leaves[begin].box;
      nodes_[static_cast<size_t>(node)].child = ~static_cast<int32_t>(leaves[begin].id);
      leaf_[leaves[begin].id] = node;
      continue;
    }
    // Half of the centres on either side along the longest extent of centres.
    float low[3] = {1e38f, 1e38f, 1e38f}, high[3] = {-1e38f, -1e38f, -1e38f};
    FloatBox all = leaves[begin].box;
    for (uint32_t k = begin; k < end; ++k) {
      all = both(all, leaves[k].box);
      for (int c = 0; c < 3; ++c) {
        const float m = leaves[k].box.low[c] + leaves[k].box.high[c];
        low[c] = std::min(low[c], m), high[c] = std::max(high[c], m);
      }
    }
    const float e[3] = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    const int c = e[0] >= e[1] && e[0] >= e[2] ? 0 : e[1] >= e[2] ? 1 : 2;
    const uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(leaves.begin() + begin, leaves.begin() + middle, leaves.begin() + end,
                     [c](const Leaf& a, const Leaf& b) {
                       const float p = a.box.low[c] + a.box.high[c], q = b.box.low[c] + b.box.high[c];
                       return p < q || (p == q && a.id < b.id);
                     });
    const int32_t pair = new_pair();
    nodes_[static_cast<size_t>(node)].box = all;
    nodes_[static_cast<size_t>(node)].child = pair;
    nodes_[static_cast<size_t>(pair)].parent = nodes_[static_cast<size_t>(pair) + 1].parent = node;
    todo.push_back({middle, end, pair + 1});
    todo.push_back({begin, middle, pair});
  }
}

}  // namespace truestep
