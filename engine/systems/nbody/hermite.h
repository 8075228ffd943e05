// Hermite's scheme of fourth order with block time steps: every body has a step of its own, the session's
// divided by a power of two, so that close pairs cost only themselves (Makino & Aarseth 1992; Makino 1991 for
// the blocks).
//   predict  x_p = x + v h + a h^2/2 + j h^3/6,  v_p = v + a h + j h^2/2          (everybody)
//   sum      a_1, j_1 of those whose step ends, over all pairs
//   correct  v_1 = v + (a + a_1) h/2 + (j - j_1) h^2/12,  x_1 = x + (v + v_1) h/2 + (a - a_1) h^2/12
//   choose   h^2 = eta (|a| |snap| + |j|^2)/(|j| |crackle| + |snap|^2)                  (Aarseth 1985), at
//   most twice the last
// At the session's step everybody has come to the same time, so that nothing else is remembered. Not here:
// the spline's softening, the tree.
#pragma once
#include "engine/core/integrator.h"

namespace truestep::nbody {

inline constexpr std::string_view kHermiteName = "hermite";

/// A row like those of the table, for fields of this system alone. `tolerance` is eta; 0.01 where the scene
/// gives none.
const Integrator& hermite();

}  // namespace truestep::nbody
