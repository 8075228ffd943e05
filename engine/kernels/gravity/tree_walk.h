// Attraction by a tree of bodies (body_tree.h), a group at a time: a node stands for its bodies when the
// resulting error is a small fraction of the group's acceleration,
//   M r^3 / d^5 < error |a_group|,   d > r,
// d from the node's centre of mass to the box around the group, r the node's radius; otherwise its children
// are tested, and finally bodies (Barnes & Hut 1986; groups: Barnes 1990; the criterion is Springel's 2005,
// eq. 18, for the second order, with radii in place of cells, and |a_group| from a first coarse walk of the
// same tree, so that no step depends on an earlier one). The sums do not obey Newton's third law exactly:
// momentum is conserved to the error of the forces.
#pragma once
#include <span>

#include "engine/kernels/gravity/body_tree.h"

namespace truestep::gravity {

struct TreeSettings {
  Softening softening;
  double opening = 1e-3;  ///< the criterion's `error`
};

/// Number of sources of a group's bodies: individually for each body, and through the group's field.
struct TreeWork {
  double bodies = 0, nodes = 0, far_nodes = 0;
};

/// a (n x 3, m/s^2) and, unless they are empty, p_i = sum_j mu_j p(r_ij) without the body's own and those at
/// its place (n, m^2/s^2) and what a group took (as many as groups).
struct TreeSums {
  std::span<double> a, p = {};
  std::span<TreeWork> work = {};
};

/// Attraction of all bodies from which the tree was built.
void tree_sums(const BodyTree& tree, const TreeSettings& settings, const TreeSums& out,
               const ThreadArena& arena);

}  // namespace truestep::gravity
