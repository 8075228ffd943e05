// The end of a free flight, in the plane and in space. Substeps move bodies by the velocities at their ends,
// which is too far by half a substep's change of velocity. A body on which only its own forces acted moves by
// the mean of the velocities at both ends instead: along its parabola.
#pragma once
#include <algorithm>

namespace truestep {

/// Puts `moved` (three coordinates) back if the velocity `v` is exactly `free`, what forces alone make of
/// `before`; n: coordinates of a velocity; late: half a substep, s.
template <int n, class T>
void end_on_parabola(const T* v, const T* free, const T* before, T late, T* moved) {
  if (!std::equal(v, v + n, free)) return;
  for (int e = 0; e < 3; ++e) moved[e] -= late * (v[e] - before[e]);
}

}  // namespace truestep
