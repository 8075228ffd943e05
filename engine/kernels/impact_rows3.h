// Impacts of rigid bodies: contacts that close within a substep faster than a threshold bounce as pairs, one
// after the other, until none comes closer. For one manifold with relative velocities u = J v, u < 0:
//   l >= 0 solves J (v + P) = 0 as well as a few passes can, P = M^-1 J^T l;   s = -(v . P) / (P . P);
//   v' = v + (1 + e) s P
// s makes J (v + s P) . l = 0 hold exactly, so that the kinetic energy changes by
//   -(1 - e^2) (v . P)^2 / (2 P . P)
// whatever the passes left over: never up, and not at all for e = 1 (Poisson's hypothesis; Smith et al. 2012,
// "Reflections on simultaneous impact"). Friction follows Coulomb with the impact's own impulse. A body that
// hits after the time tau moves at its old velocity until then, `late` gets tau (v - v'), and forces have
// acted on what it hits with until then.
#pragma once
#include "engine/kernels/contact_solve3.h"

namespace truestep {

template <class T>
struct ImpactPass {
  T h;          ///< s, of the substep
  T threshold;  ///< m/s; slower contacts do not bounce
};

/// Records of the bodies.
template <class T>
struct ImpactRecords {
  Record8<T>* velocity;
  const Record8<T>* change;  ///< of velocity by forces, in a substep; already in `velocity`
  Record8<T>* late;          ///< to be added to the displacements at the end of the substep
};

/// Lets the due contacts of a group bounce; false when there are none.
template <class T>
bool hit_contacts(ContactGroup<T>& g, const ImpactRecords<T>& bodies, uint32_t end,
                  const ImpactPass<T>& pass) {
  using W = Wide<T>;
  namespace r = contact_rows;
  constexpr int kPasses = 8;
  const W zero(0), one(1);
  W a[6], b[6], speed[4], closes[4], due(0), wait(T(1e30));
  gather6(bodies.velocity, g.a, a), gather6(bodies.velocity, g.b, b);
  const W linear = g.root_b * r::dot(g.normal, b) - g.root_a * r::dot(g.normal, a);
  for (int p = 0; p < g.points; ++p) {
    const auto& q = g.point[p];
    speed[p] = linear + (r::dot(q.jb, b + 3) - r::dot(q.ja, a + 3)) + g.place[p].drift;
    const W reached = -madd(speed[p], W(pass.h), g.place[p].apart);
    // In lanes without a point, or where nothing bounces, the inverse or e is zero.
    closes[p] = where_positive(q.inverse_k,
                               where_positive(reached, where_positive(-speed[p], one, zero), zero), zero);
    due = where_positive(-speed[p] - W(pass.threshold), max(due, closes[p]), due);
    const W reaches = max(g.place[p].apart, zero) / where_positive(-speed[p], -speed[p], one);
    wait = where_positive(closes[p], min(wait, reaches), wait);
  }
  due = where_positive(g.restitution, due, zero);
  if (!any_below(zero, due)) return false;
  {
    W fa[6], fb[6];
    gather6(bodies.change, g.a, fa), gather6(bodies.change, g.b, fb);
    const W still = max(one - wait * W(1 / pass.h), zero);
    // Pulls only: gyroscopic torques would have to follow the new spin for energy to stay.
    const W pulls = g.root_b * r::dot(g.normal, fb) - g.root_a * r::dot(g.normal, fa);
    for (int p = 0; p < g.points; ++p) speed[p] = nmadd(still, pulls, speed[p]);
  }

  // Compression.
  const W k = g.root_a * g.root_a + g.root_b * g.root_b;
  W l[4] = {}, turn_a[3] = {}, turn_b[3] = {}, sum(0);
  for (int e = 0; e < (g.points > 1 ? kPasses : 1); ++e) {
    for (int p = 0; p < g.points; ++p) {
      const auto& q = g.point[p];
      const W u = madd(k, sum, speed[p]) + (r::dot(q.jb, turn_b) - r::dot(q.ja, turn_a));
      const W total = max(nmadd(q.inverse_k, u, l[p]), zero) * closes[p], added = total - l[p];
      l[p] = total, sum += added;
      r::subtract(turn_a, added, q.ja), r::add(turn_b, added, q.jb);
    }
  }
  W work(0), torque(0), x(0), y(0);
  for (int p = 0; p < g.points; ++p) {
    work = madd(l[p], speed[p], work);
    torque = madd(g.lever[p], l[p], torque);
    x = madd(g.place[p].x, l[p], x), y = madd(g.place[p].y, l[p], y);
  }
  const W square = madd(k * sum, sum, r::dot(turn_a, turn_a) + r::dot(turn_b, turn_b));
  const W scale = due * max(-work, zero) * (one + g.restitution) / where_positive(square, square, one);
  if (!any_below(zero, scale)) return false;
  const W pressed = where_positive(sum, sum, one);
  sum *= scale, torque *= scale;
  x = x / pressed, y = y / pressed;

  W da[6], db[6];
  for (int e = 0; e < 3; ++e) {
    da[e] = -(sum * g.root_a) * g.normal[e], db[e] = (sum * g.root_b) * g.normal[e];
    da[3 + e] = turn_a[e] * scale, db[3 + e] = turn_b[e] * scale;
  }
  // Friction where the impact acts, x and y off the centre of the rows.
  W ja[2][3], jb[2][3], slip[2];
  for (int e = 0; e < 3; ++e) {
    ja[0][e] = nmadd(y, g.nja[e], g.tja[0][e]), jb[0][e] = nmadd(y, g.njb[e], g.tjb[0][e]);
    ja[1][e] = madd(x, g.nja[e], g.tja[1][e]), jb[1][e] = madd(x, g.njb[e], g.tjb[1][e]);
  }
  for (int e = 0; e < 6; ++e) a[e] += da[e], b[e] += db[e];
  const W spin = r::dot(g.njb, b + 3) - r::dot(g.nja, a + 3) + g.twist_drift;
  const W twist = max(min(-(g.twist_k * spin), torque), -torque);
  r::subtract(da + 3, twist, g.nja), r::add(db + 3, twist, g.njb);
  r::subtract(a + 3, twist, g.nja), r::add(b + 3, twist, g.njb);
  for (int t = 0; t < 2; ++t) {
    slip[t] = g.root_b * r::dot(g.tangent[t], b) - g.root_a * r::dot(g.tangent[t], a) +
              (r::dot(jb[t], b + 3) - r::dot(ja[t], a + 3)) + g.slide_drift[t];
  }
  slip[0] = nmadd(y, g.twist_drift, slip[0]), slip[1] = madd(x, g.twist_drift, slip[1]);
  W inverse[3];
  r::invert(k + r::dot(ja[0], ja[0]) + r::dot(jb[0], jb[0]), r::dot(ja[0], ja[1]) + r::dot(jb[0], jb[1]),
            k + r::dot(ja[1], ja[1]) + r::dot(jb[1], jb[1]), inverse);
  W slide[2] = {zero, zero}, added[2];
  const W wanted[2] = {-madd(inverse[1], slip[1], inverse[0] * slip[0]),
                       -madd(inverse[2], slip[1], inverse[1] * slip[0])};
  r::clip(slide, wanted, g.friction * sum, added);
  for (int t = 0; t < 2; ++t) {
    r::subtract(da, added[t] * g.root_a, g.tangent[t]), r::add(db, added[t] * g.root_b, g.tangent[t]);
    r::subtract(da + 3, added[t], ja[t]), r::add(db + 3, added[t], jb[t]);
  }

  W wa[6], wb[6];
  gather6(bodies.velocity, g.a, a), gather6(bodies.velocity, g.b, b);
  gather6(bodies.late, g.a, wa), gather6(bodies.late, g.b, wb);
  for (int e = 0; e < 6; ++e) {
    a[e] += da[e], b[e] += db[e];
    wa[e] = nmadd(wait, da[e], wa[e]), wb[e] = nmadd(wait, db[e], wb[e]);
  }
  scatter6(bodies.velocity, g.a, end, a), scatter6(bodies.velocity, g.b, end, b);
  scatter6(bodies.late, g.a, end, wa), scatter6(bodies.late, g.b, end, wb);
  return true;
}

}  // namespace truestep
