// When two moving solids first come close: conservative advancement (Mirtich 1996). At distance d along the
// normal n no point of either can close the gap sooner than
//   d / (n . (v_a - v_b) + |w_a| r_a + |w_b| r_b),
// so advancing repeatedly by that time never passes through anything, however thin or fast. For balls, which
// rotation does not change, against flat surfaces the first advance arrives.
#pragma once
#include <optional>

#include "engine/collision/queries/sweep.h"
#include "engine/geometry/solid.h"

namespace truestep {

struct Impact {
  double t = 0;    ///< fraction of the sweep in [0, 1]
  Vec3 normal;     ///< unit, from a to b at that time
  Vec3 point;      ///< m, half way between both
  double gap = 0;  ///< m, at that time
  uint32_t part_a = 0, part_b = 0;
};

/// First time at which the gap is at most `touch` (m > 0); it is then more than half of that, unless it was
/// smaller from the start: then t = 0. Empty when that does not happen, or when the sweep ends with a gap
/// between half of `touch` and all of it. Any two solids except surface against surface; triangles count
/// while the other's centre is in front of them, and planes must not rotate. Grazing contact may be reported
/// up to twice `touch` early.
std::optional<Impact> time_of_impact(const Solid& a, const Sweep& sweep_a, const Solid& b,
                                     const Sweep& sweep_b, double touch);

}  // namespace truestep
