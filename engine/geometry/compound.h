// Several solids as one body: parts with their poses in the body's frame, in a tree.
#pragma once
#include <vector>

#include "engine/geometry/solid.h"
#include "engine/geometry/static_tree.h"

namespace truestep {

class Compound {
 public:
  struct Part {
    Solid solid;
    Transform place;
  };
  /// Error "bad_solid" when there is no part or one is not convex.
  explicit Compound(const std::vector<SolidPart>& parts);

  const std::vector<Part>& parts() const { return parts_; }
  const StaticTree& tree() const { return tree_; }

 private:
  std::vector<Part> parts_;
  StaticTree tree_;
};

}  // namespace truestep
