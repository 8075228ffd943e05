// The effect of a contact on a point's velocity w relative to the surface, with outward unit normal n. Impact
// (Newton's restitution, Coulomb's friction as an impulse, Brach 2007 ch. 2):
//   w_n' = -e w_n,   w_t' = w_t - min(mu (1 + e) |w_n|, |w_t|) w_t/|w_t|
// Support over a time tau under a constant acceleration a with a.n < 0 (block on an incline):
//   w_n' = 0,        w_t' = (w_t + a_t tau) shortened by mu |a_n| tau, at most to zero (stick)
// One coefficient serves for static and kinetic friction.
#pragma once
#include <algorithm>

#include "engine/math/vec3.h"

namespace truestep {

/// Velocity relative to the surface after an impact with w.n < 0; e in [0, 1], mu >= 0.
template <class T>
Vec3T<T> impact(const Vec3T<T>& w, const Vec3T<T>& n, T e, T mu) {
  const T wn = dot(w, n);
  const Vec3T<T> wt = w - n * wn;
  const T speed = norm(wt), grip = mu * (1 + e) * -wn;
  const T keep = speed > grip ? 1 - grip / speed : T(0);
  return wt * keep - n * (e * wn);
}

/// Motion of a supported point over tau: its velocity at the start and the mean acceleration, both
/// tangential.
template <class T>
struct Support {
  Vec3T<T> velocity;      ///< relative to the surface, m/s
  Vec3T<T> acceleration;  ///< constant acceleration with the same displacement and final velocity, m/s^2
};

/// Motion over tau (s) of a point pressed against the surface by a.n < 0. The impulse that stopped the
/// approach w.n < 0 causes friction as well. The displacement is exact for straight sliding that stops within
/// tau.
template <class T>
Support<T> support(const Vec3T<T>& w, const Vec3T<T>& a, const Vec3T<T>& n, T mu, T tau) {
  const T wn = std::min(dot(w, n), T(0)), an = std::min(dot(a, n), T(0));
  Vec3T<T> wt = w - n * dot(w, n);
  const T speed = norm(wt), grip = mu * -wn;
  wt *= speed > grip ? 1 - grip / speed : T(0);
  if (!(tau > 0)) return {wt, {}};
  const Vec3T<T> at = a - n * dot(a, n);
  const Vec3T<T> free = wt + at * tau;
  const T reach = norm(free), brake = mu * -an * tau;
  if (brake < reach) return {wt, at - free * (brake / (reach * tau))};
  // The point stops after the fraction f of tau: its displacement x = wt f tau / 2 equals that of a motion
  // with wt' = f wt that stops at the end of tau, and both have the required final velocity of zero.
  const T f = brake > 0 ? reach / brake : T(0);
  return {wt * f, wt * (-f / tau)};
}

}  // namespace truestep
