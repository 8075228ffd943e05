// Planets with close encounters: Kepler ellipses about the first body while they are far apart, an adaptive
// method for those that come close (Chambers 1999; Rein, Hernandez, Tamayo et al. 2019, "MERCURIUS"). In
// democratic heliocentric coordinates, Q_i = x_i - x_0 and V_i = v_i - v of the centre of mass,
//   H = sum_i [ m_i V_i^2/2 - G m_0 m_i/|Q_i| ]          ellipses, except in encounters
//     + (sum_i m_i V_i)^2/2 m_0                          "jump": the sun's own motion
//     - sum_{i<j} G m_i m_j/r_ij                         pairs
// a pair's force F is split by L(r), which is 0 within a tenth of the changeover radius and 1 beyond it:
//   step = kick by L F for h/2, jump h/2, drift h, jump h/2, kick h/2
// where in the drift, bodies that come within their changeover radius of another during the step are moved by
// ias15 under the sun's attraction and (1 - L) F of each other. That radius is the larger of three Hill radii
// and of 0.4 h times the circular speed (Rein et al., section 2.5), fixed for the whole run from the orbit at
// its start. Rows: the sun first, the others in any order. Not covered: close approaches to the sun (h must
// resolve them), spline softening, collisions, pushes.
#pragma once
#include "engine/core/equations/integrator.h"

namespace truestep::nbody {

inline constexpr std::string_view kMercuriusName = "mercurius";

/// A row like those of the table, for this system's fields only. `tolerance` is that of ias15 in encounters.
const Integrator& mercurius();

}  // namespace truestep::nbody
