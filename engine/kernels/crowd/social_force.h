// Forces between pedestrians and on walls (Helbing, Farkas, Vicsek 2000, Nature 407:487, eqs. 2 and 3) as
// pure functions of positions in the plane:
//   f_ij = (A exp((r - d)/B) + k g(r - d)) n + kappa g(r - d) (dv . t) t,  r = r_i + r_j, g(x) = max(x, 0)
// with n from j to i and dv = v_j - v_i. A wall has no radius and no velocity. Units: N, m, s; z = 0
// throughout. Not here: the driving force, which the system integrates exactly.
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

/// A push from one other person, split into the parts that its users need.
struct SocialForce {
  Vec3 social;         ///< N, repulsion without contact
  Vec3 contact;        ///< N, compression and friction
  double radial = 0;   ///< N, sum of magnitudes along the normal
  double sliding = 0;  ///< kg/s, coefficient of the friction
};

/// Unit vector from one to the other, or `fallback` when they coincide.
inline Vec3 apart(const Vec3& d, double distance, const Vec3& fallback) {
  return distance > 0 ? d / distance : fallback;
}

/// Force on a person at distance `distance` along the unit vector n from another (or from a wall), with radii
/// that add up to `reach` and dv (m/s), the other's velocity minus their own.
inline SocialForce social_force(const SocialLaw& law, const Vec3& n, double distance, double reach,
                                const Vec3& dv) {
  // Beyond the largest overlap that numbers can hold, the exact force does not matter.
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

/// Weight of a push by its direction: 1 from ahead, lambda from behind (Helbing, Molnar 1995, in the form of
/// Helbing et al. 2005). `heading` unit or zero, n from the other to here.
inline double attention(double lambda, const Vec3& heading, const Vec3& n) {
  return lambda + (1 - lambda) * 0.5 * (1 - dot(heading, n));
}

}  // namespace truestep::crowd
