// Attraction by a tree of bodies whose nodes receive the field of far nodes as a whole (fast multipole
// method: Greengard & Rokhlin 1987, by a dual traversal of one tree, Dehnen 2002). A node with many bodies
// interacts with the nodes left over by its parent:
//   far enough, 4 M (r + r_n)^3 < error |a| s^3 (s - r - r_n)^2:  the field is added to the node's series
//                                                                (local_field.h)
//   larger than the node:                                        it is opened
//   otherwise:                                                   it is left over for the node's children.
// The node then passes series and leftovers to its children, and in the end to groups, which continue as in
// tree_walk.h. The series are of third order in sizes over distances, as there. Momentum is conserved to the
// error of the forces.
#pragma once
#include <memory>

#include "engine/kernels/gravity/tree_walk.h"

namespace truestep::gravity {

/// Memory of the downward pass; grows in the first evaluations.
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

/// As tree_sums. `out.work` counts only the groups' own interactions, not those in a series.
void multipole_sums(const BodyTree& tree, const TreeSettings& settings, const TreeSums& out,
                    MultipoleScratch& scratch, const ThreadArena& arena);

}  // namespace truestep::gravity
