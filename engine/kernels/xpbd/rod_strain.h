// Strains of a Cosserat rod with positions at its points and frames on its links (Kugelstadt, Schoemer 2016,
// "Position and orientation based Cosserat rods"). A frame q turns (e1, e2, e3) into the section's axes and
// the rod's direction:
//   stretch and shear of a link     G = R(q)^T (x1 - x0) / l - e3        (1; G3 stretch, G1 and G2 shear)
//   bending and twist of a joint    O = 2 / l Im(conj(qa) qb) - O0       (1/m, in the frames' own axes)
// with l the rest length; for a joint, half of the two links it connects. Both are invariant under rigid
// motion. With the material's moduli the energy is
//   1/2 l (G A_s (G1^2 + G2^2) + E A G3^2) + 1/2 l (E I1 O1^2 + E I2 O2^2 + G J O3^2).
// q and -q are the same frame: the sign of conj(qa) qb is chosen so that its real part is positive, so two
// successive links turn relative to each other by less than half a circle.
#pragma once
#include "engine/math/quaternion.h"

namespace truestep::xpbd {

/// x1 - x0 = d, m; rest length l, m.
inline Vec3 stretch_and_shear(const Vec3& d, const Quat& q, double l) {
  const Vec3 g = rotation(q).apply_inverse(d) * (1 / l);
  return {g.x, g.y, g.z - 1};
}

/// conj(a) b with a non-negative real part: the rotation from a to b in a's axes.
inline Quat turn_between(const Quat& a, const Quat& b) {
  const Quat p = Quat{a.w, -a.x, -a.y, -a.z} * b;
  return p.w < 0 ? Quat{-p.w, -p.x, -p.y, -p.z} : p;
}

/// 2 / l Im(conj(a) b), 1/m.
inline Vec3 bend_and_twist(const Quat& a, const Quat& b, double l) {
  const Quat p = turn_between(a, b);
  return Vec3{p.x, p.y, p.z} * (2 / l);
}

/// q turned by the vector a (rad, in q's own axes) with Cayley's map: by 2 atan(|a| / 2), which needs no sine
/// and stays below half a circle.
inline Quat turned_by(const Quat& q, const Vec3& a) {
  return normalized(q * Quat{1, 0.5 * a.x, 0.5 * a.y, 0.5 * a.z});
}

}  // namespace truestep::xpbd
