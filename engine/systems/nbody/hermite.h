// Hermite's scheme of fourth order with block time steps: every body has its own step, the session's divided
// by a power of two, so that close pairs cost only their own work (Makino & Aarseth 1992; Makino 1991 for the
// blocks).
//   predict  x_p = x + v h + a h^2/2 + j h^3/6,  v_p = v + a h + j h^2/2          (everybody)
//   sum      a_1, j_1 of those whose step ends, over all pairs
//   correct  v_1 = v + (a + a_1) h/2 + (j - j_1) h^2/12,  x_1 = x + (v + v_1) h/2 + (a - a_1) h^2/12
//   choose   h^2 = eta (|a| |snap| + |j|^2)/(|j| |crackle| + |snap|^2), at most twice the last h
//            (Aarseth 1985)
// At the session's step all bodies have reached the same time, so nothing else is remembered. Not covered:
// spline softening, the tree.
#pragma once
#include "engine/core/equations/integrator.h"

namespace truestep::nbody {

inline constexpr std::string_view kHermiteName = "hermite";

/// A row like those of the table, for this system's fields only. `tolerance` is eta; default 0.01.
const Integrator& hermite();

}  // namespace truestep::nbody
