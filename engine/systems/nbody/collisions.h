// Balls that touch during a step. Paths are straight from the step's start to its end; the first touch of two
// balls is the smaller root of |d0 + s (d1 - d0)| = R. Pairs are handled in order of touch, each body once
// per step:
//   merge   one body with both masses, their centre of mass, momentum and volume, in the row of the heavier
//   bounce  j = -(1 + e) (u.n) m_r n along the line n between them, m_r = m_a m_b/(m_a + m_b)
//   stop    j = -m_r u: they go on together
// Not covered: spin, friction, the rest of a step after two touches of one body.
#pragma once
#include "engine/core/state/workspace.h"
#include "engine/systems/nbody/nbody_def.h"
#include "engine/systems/nbody/nbody_state.h"

namespace truestep::nbody {

/// `before` (n x 3, m): positions at the step's start. h in s.
void collide(State& s, const CollisionsDef& def, std::span<const double> before, double h,
             Workspace& workspace);

}  // namespace truestep::nbody
