#include "engine/geometry/compound.h"

#include "engine/base/errors.h"

namespace truestep {

Compound::Compound(const std::vector<SolidPart>& parts) {
  if (parts.empty()) throw Error("bad_solid", "a compound needs at least one part");
  std::vector<Box> boxes;
  for (const SolidPart& p : parts) {
    if (!is_convex(p.solid.kind)) throw Error("bad_solid", "the parts of a compound must be convex");
    parts_.push_back({p.solid, transform_of({p.pose.position, normalized(p.pose.orientation)})});
    boxes.push_back(truestep::bounds(p.solid, parts_.back().place));
  }
  tree_.build(boxes);
}

}  // namespace truestep
