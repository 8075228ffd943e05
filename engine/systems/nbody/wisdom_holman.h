// Wisdom and Holman's splitting for bodies about a dominant one: exact Kepler ellipses, with the planets'
// mutual attraction as kicks in between, so that the energy error is a fraction (mass of the planets/mass of
// the sun) h^2 and does not grow (Wisdom & Holman 1991). In Jacobi coordinates, where body i is relative to
// the centre of mass of those before it, with eta_i = m_0 + ... + m_i:
//   H = P^2/2M + sum_i [ p_i'^2/2 mu_i - G mu_i eta_i/r_i' ]
//     + [ sum_i G mu_i eta_i/r_i' - sum_{i<j} G m_i m_j/r_ij ]
//   step = drift by the first line for h/2, kick by the second for h, drift for h/2  (Rein & Tamayo 2015)
// Rows must be in order: the heavy one first, then from the inside out. Not covered: close encounters,
// correctors.
#pragma once
#include "engine/core/equations/integrator.h"

namespace truestep::nbody {

inline constexpr std::string_view kWisdomHolmanName = "wisdom_holman";

/// A row like those of the table, for this system's fields only.
const Integrator& wisdom_holman();

}  // namespace truestep::nbody
