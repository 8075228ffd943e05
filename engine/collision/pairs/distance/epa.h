// Depth of two overlapping cores by the expanding polytope algorithm (van den Bergen 2001): the direction in
// which the difference set {a - b} reaches least far from the origin. Bounded: 96 points, fixed memory.
#pragma once
#include <span>

#include "engine/collision/pairs/distance/gjk.h"

namespace truestep {

struct CoreDepth {
  double depth = 0;       ///< m; moving b by depth along the normal separates the cores
  Vec3 normal{0, 1, 0};   ///< unit, from a to b
  Vec3 point_a, point_b;  ///< touching points of the cores, set by refine()
  enum class Source : uint8_t { guess, search } source = Source::search;
};

/// `start`: what core_distance found for the same pair (verdict overlap). `guesses`: directions that may be
/// the answer (face normals ...); good ones end the search early. Accurate to 1e-7 of the solids' size for
/// flat features, to 1e-4 for round ones.
CoreDepth core_depth(const Convex& a, const Convex& b, const Transform& b_in_a, const Simplex& start,
                     std::span<const Vec3> guesses);

/// Finds the touching points and a better normal: with b moved out along n by more than the depth, the
/// direction of the nearest points never has a larger depth than n.
void refine(const Convex& a, const Convex& b, const Transform& b_in_a, double size, CoreDepth& depth);

}  // namespace truestep
