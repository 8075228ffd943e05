// Forces between pedestrians and on walls (Helbing, Farkas, Vicsek 2000, Nature 407:487, eqs. 2 and 3) as
// pure functions of places in the plane:
//   f_ij = (A exp((r - d)/B) + k g(r - d)) n + kappa g(r - d) (dv . t) t,  r = r_i + r_j, g(x) = max(x, 0)
// with n from j to i and dv = v_j - v_i. A wall has no radius and no velocity. Units: N, m, s; z = 0
// throughout. Not here: the way somebody wants to go, which the system solves exactly.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"
#include "engine/math/vec3.h"

namespace truestep::crowd {

struct SocialLaw {
  double strength = 2000;    ///< N, A
  double range = 0.08;       ///< m, B
  double stiffness = 1.2e5;  ///< kg/s^2, k
  double friction = 2.4e5;   ///< kg/(m s), kappa
};

/// A push by one other, split as its users need it.
struct SocialForce {
  Vec3 social;         ///< N, repulsion without contact
  Vec3 contact;        ///< N, compression and friction
  double radial = 0;   ///< N, size of all that acts along the normal
  double sliding = 0;  ///< kg/s, coefficient of the friction
};

/// Unit vector from one to the other, or `fallback` where they coincide.
inline Vec3 apart(const Vec3& d, double distance, const Vec3& fallback) {
  return distance > 0 ? d / distance : fallback;
}

/// Force on whoever is at distance `distance` along unit n from another (or from a wall), with radii that sum
/// up to `reach` and the other's velocity less the own one, dv (m/s).
inline SocialForce social_force(const SocialLaw& law, const Vec3& n, double distance, double reach,
                                const Vec3& dv) {
  // Beyond the longest overlap that numbers hold there is nobody to ask how hard it is.
  const double gap = reach - distance;
  const double push = law.strength * trig::exp(std::min(gap / law.range, 50.0));
  SocialForce f;
  f.social = n * push, f.radial = push;
  if (gap <= 0) return f;
  const Vec3 t{-n.y, n.x, 0};
  f.sliding = law.friction * gap;
  f.contact = n * (law.stiffness * gap) + t * (f.sliding * dot(dv, t));
  f.radial += law.stiffness * gap;
  return f;
}

/// Share of a push that comes from where somebody looks: 1 ahead, lambda behind (Helbing, Molnar 1995, in the
/// form of Helbing et al. 2005). `heading` unit or zero, n from the other to here.
inline double attention(double lambda, const Vec3& heading, const Vec3& n) {
  return lambda + (1 - lambda) * 0.5 * (1 - dot(heading, n));
}

}  // namespace truestep::crowd
