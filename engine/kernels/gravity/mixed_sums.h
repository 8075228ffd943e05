// Attraction of all bodies by all others in mixed precision: the groups of a tree (body_tree.h), whose bodies
// are near each other, meet every body in floats relative to the group's centre, and the sums of 512 at a
// time are added up in doubles. Groups within one and a half radii of a group meet it in doubles, because
// relative to the centre a float knows their distance from a neighbour badly. A relative position is then
// known to 6e-8 of at most five times the distance that counts: errors of some 1e-7 a pair, of random sign.
// Momentum is kept to that error.
#pragma once
#include "engine/kernels/gravity/body_tree.h"

namespace truestep::gravity {

/// Where groups are, in the tree's lengths: centre and radius. Grows once.
struct MixedScratch {
  std::vector<std::array<double, 4>> places;
};

/// a (n x 3, m/s^2) of every body that the tree was built from.
void mixed_accelerations(const BodyTree& tree, const Softening& softening, std::span<double> a,
                         MixedScratch& scratch, const ThreadArena& arena);

}  // namespace truestep::gravity
