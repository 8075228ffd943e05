// Attraction by a tree of bodies whose nodes take the field of far nodes as wholes (fast multipole method:
// Greengard & Rokhlin 1987, by a dual traversal of one tree, Dehnen 2002). A node of many bodies is met by
// the nodes that its parent left over:
//   far enough   its field is added to the node's series (local_field.h)          4 M (r + r_n)^3 < error |a|
//   s^3 (s - r - r_n)^2 larger       it is opened else         it is left over for the node's children
// then hands series and leftovers to its children, and in the end to groups, which go on as in tree_walk.h.
// What a series holds is of third order in sizes over distances, as there. Momentum is conserved to the error
// of the forces.
#pragma once
#include <memory>

#include "engine/kernels/gravity/tree_walk.h"

namespace truestep::gravity {

/// What is remembered on the way down; grows in the first evaluations.
class MultipoleScratch {
 public:
  MultipoleScratch();
  ~MultipoleScratch();
  MultipoleScratch(const MultipoleScratch& other);
  MultipoleScratch& operator=(const MultipoleScratch&) = delete;
  struct Parts;
  Parts& parts() { return *parts_; }

 private:
  std::unique_ptr<Parts> parts_;
};

/// As tree_sums. `out.work` counts what groups met themselves, not what came with a series.
void multipole_sums(const BodyTree& tree, const TreeSettings& settings, const TreeSums& out,
                    MultipoleScratch& scratch, const ThreadArena& arena);

}  // namespace truestep::gravity
