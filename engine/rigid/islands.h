// Islands: bodies that touch or are joined, directly or through others. A union-find forest in which the body
// with the lowest index is the root of its island, so that the result depends on the links alone, not on
// their order.
#pragma once
#include <cstdint>
#include <span>

namespace truestep {

/// Makes every body an island of its own.
inline void start_islands(std::span<uint32_t> parent) {
  for (size_t i = 0; i < parent.size(); ++i) parent[i] = static_cast<uint32_t>(i);
}

/// The lowest body of i's island; compresses the path to it.
inline uint32_t island_of(std::span<uint32_t> parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// Merges two islands.
inline void link_islands(std::span<uint32_t> parent, uint32_t a, uint32_t b) {
  a = island_of(parent, a), b = island_of(parent, b);
  if (a < b) parent[b] = a;
  if (b < a) parent[a] = b;
}

/// Replaces the value of every body by the smallest in its island.
template <class T>
void spread_minimum(std::span<uint32_t> parent, std::span<T> value) {
  // A root is the lowest body of its island: going down, every body passes its value to the root; going up,
  // it takes the root's.
  for (size_t i = parent.size(); i-- > 0;) {
    const uint32_t r = island_of(parent, static_cast<uint32_t>(i));
    if (value[i] < value[r]) value[r] = value[i];
  }
  for (size_t i = 0; i < parent.size(); ++i) value[i] = value[island_of(parent, static_cast<uint32_t>(i))];
}

}  // namespace truestep
