// A body on fine ground touches many triangles in one plane; to a solver this is one contact.
#pragma once
#include <vector>

#include "engine/collision/pairs/manifold.h"

namespace truestep {

/// Adds `m` to the manifolds from index `first` on: merged into one with the same part_b whose normal agrees
/// to 1e-4 rad, keeping the lower part_a and the best four points, otherwise as a new one. Points closer than
/// `same` (m) to an existing one are dropped.
void merge_manifold(const Manifold& m, size_t first, double same, std::vector<Manifold>& all);

/// Id of a point that also tells which parts met, for points that change manifolds.
constexpr uint32_t mixed_id(uint32_t id, uint32_t part_a, uint32_t part_b) {
  return id * 0x9e3779b1u ^ part_a * 0x85ebca77u ^ part_b * 0xc2b2ae3du;
}

}  // namespace truestep
