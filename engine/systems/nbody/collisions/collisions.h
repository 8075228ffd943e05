// What happens to balls that touch:
//   merge   one body with both masses, their centre of mass, momentum and volume, in the row of the heavier
//   bounce  j = -(1 + e) (u.n) m_r n along the line n between them, m_r = m_a m_b/(m_a + m_b)
//   stop    j = -m_r u: they go on together
// Spin and friction are not covered.
#pragma once
#include <vector>

#include "engine/systems/nbody/collisions/touches.h"
#include "engine/systems/nbody/nbody_def.h"
#include "engine/systems/nbody/nbody_state.h"

namespace truestep::nbody {

/// A share of the change of relative velocity that goes to a: the other's part of the mass; half of it for
/// two massless bodies.
inline double share_of_first(double mass_a, double mass_b) {
  return mass_a + mass_b > 0 ? mass_b / (mass_a + mass_b) : 0.5;
}

/// Change of the relative velocity u (m/s, of b as seen from a) of bodies that touch along the unit vector n
/// from a to b.
Vec3 change_of_velocity(const Vec3& u, const Vec3& n, Response response, double restitution);

/// One body in row `into`; row `gone` is to be removed.
void merge(State& s, uint32_t into, uint32_t gone);

/// Many bodies of which some touch: each touch changes the two bodies alone, for the rest of the step of h
/// (s) along straight lines; later touches of a body that has bounced are counted as left over and returned.
uint64_t collide_apart(State& s, const CollisionsDef& def, const PathPiece& piece,
                       std::span<const Touch> touches, Workspace& workspace);

}  // namespace truestep::nbody
