// Islands: bodies that touch or are joined, directly or through others. A forest of parents in which the
// smallest body of an island is its root, so that the result depends on the links alone, not on their order.
#pragma once
#include <cstdint>
#include <span>

namespace truestep {

/// Every body alone.
inline void start_islands(std::span<uint32_t> parent) {
  for (size_t i = 0; i < parent.size(); ++i) parent[i] = static_cast<uint32_t>(i);
}

/// Smallest body of i's island; shortens the way there.
inline uint32_t island_of(std::span<uint32_t> parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// Makes one island of two.
inline void link_islands(std::span<uint32_t> parent, uint32_t a, uint32_t b) {
  a = island_of(parent, a), b = island_of(parent, b);
  if (a < b) parent[b] = a;
  if (b < a) parent[a] = b;
}

/// For every body the smallest `value` of its island, in place of its own.
template <class T>
void spread_minimum(std::span<uint32_t> parent, std::span<T> value) {
  // A root is the smallest of its island: going down, every body hands on to it; going up, it hands back.
  for (size_t i = parent.size(); i-- > 0;) {
    const uint32_t r = island_of(parent, static_cast<uint32_t>(i));
    if (value[i] < value[r]) value[r] = value[i];
  }
  for (size_t i = 0; i < parent.size(); ++i) value[i] = value[island_of(parent, static_cast<uint32_t>(i))];
}

}  // namespace truestep
