// Attraction of all bodies by all others in mixed precision: the groups of a tree (body_tree.h), whose bodies
// are close to each other, interact with every body in floats relative to the group's centre, and the sums of
// 512 at a time are accumulated in doubles. Groups within one and a half radii of a group use doubles,
// because relative to the centre a float resolves the distance of neighbours badly. A relative position is
// then known to 6e-8 of at most five times the relevant distance: errors of about 1e-7 per pair, of random
// sign. Momentum is conserved to that error.
#pragma once
#include "engine/kernels/gravity/body_tree.h"

namespace truestep::gravity {

/// Centres and radii of groups, in the tree's lengths. Grows once.
struct MixedScratch {
  std::vector<std::array<double, 4>> places;
};

/// a (n x 3, m/s^2) of every body from which the tree was built.
void mixed_accelerations(const BodyTree& tree, const Softening& softening, std::span<double> a,
                         MixedScratch& scratch, const ThreadArena& arena);

}  // namespace truestep::gravity
