// One-way bodies, in the plane and in space: solid to bodies that move against their direction, open to those
// that move along it.
#pragma once

namespace truestep {

/// Whether a one-way body holds another one. `facing`: cosine between its direction and the contact's normal
/// towards the other; `along`: velocity or displacement of the other relative to it, along its direction.
inline bool one_way_holds(double facing, double along) {
  constexpr double kLeastFacing = 0.5;
  return facing >= kLeastFacing && along <= 0;
}

}  // namespace truestep
