// Passes over groups of contacts (contact_rows3.h): a patch whose points hold a body is solved at once, by
// the inverse of K over its six rows; where that would pull or slide, its rows one by one, friction by the
// impulses of the points as they are.
#pragma once
#include "engine/kernels/contact_rows3.h"

namespace truestep {

/// Adds every impulse of the group to the records (scaled velocities).
template <class T>
void apply_contacts(const ContactGroup<T>& g, Record8<T>* records, uint32_t end) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W a[6], b[6], sum(0);
  gather6(records, g.a, a), gather6(records, g.b, b);
  for (int p = 0; p < g.points; ++p) {
    const auto& q = g.point[p];
    const W& l = g.place[p].impulse;
    sum += l;
    r::subtract(a + 3, l, q.ja), r::add(b + 3, l, q.jb);
  }
  r::subtract(a, sum * g.root_a, g.normal), r::add(b, sum * g.root_b, g.normal);
  for (int t = 0; t < 2; ++t) {
    r::subtract(a, g.slide[t] * g.root_a, g.tangent[t]), r::add(b, g.slide[t] * g.root_b, g.tangent[t]);
    r::subtract(a + 3, g.slide[t], g.tja[t]), r::add(b + 3, g.slide[t], g.tjb[t]);
  }
  r::subtract(a + 3, g.twist, g.nja), r::add(b + 3, g.twist, g.njb);
  if (g.flags & ContactGroup<T>::kRolls) {
    for (int t = 0; t < 2; ++t) {
      r::subtract(a + 3, g.roll[t], g.rja[t]), r::add(b + 3, g.roll[t], g.rjb[t]);
    }
  }
  scatter6(records, g.a, end, a), scatter6(records, g.b, end, b);
}

namespace detail {
/// Rolling, twist and slide of a group, for the normal impulses as they are.
template <class T>
void solve_friction(ContactGroup<T>& g, Wide<T> a[6], Wide<T> b[6]) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W pressure(0), torque(0);
  for (int p = 0; p < g.points; ++p) {
    pressure += g.place[p].impulse;
    torque = madd(g.lever[p], g.place[p].impulse, torque);
  }
  if (g.flags & ContactGroup<T>::kRolls) {
    W slip[2], change[2], added[2];
    for (int t = 0; t < 2; ++t) slip[t] = r::dot(g.rjb[t], b + 3) - r::dot(g.rja[t], a + 3);
    change[0] = -madd(g.roll_k[1], slip[1], g.roll_k[0] * slip[0]);
    change[1] = -madd(g.roll_k[2], slip[1], g.roll_k[1] * slip[0]);
    r::clip(g.roll, change, g.rolling * pressure, added);
    for (int t = 0; t < 2; ++t) r::subtract(a + 3, added[t], g.rja[t]), r::add(b + 3, added[t], g.rjb[t]);
  }
  {
    const W speed = r::dot(g.njb, b + 3) - r::dot(g.nja, a + 3) + g.twist_drift;
    const W total = max(min(nmadd(g.twist_k, speed, g.twist), torque), -torque), added = total - g.twist;
    g.twist = total;
    r::subtract(a + 3, added, g.nja), r::add(b + 3, added, g.njb);
  }
  {
    W slip[2], change[2], added[2];
    for (int t = 0; t < 2; ++t) {
      slip[t] = g.root_b * r::dot(g.tangent[t], b) - g.root_a * r::dot(g.tangent[t], a) +
                (r::dot(g.tjb[t], b + 3) - r::dot(g.tja[t], a + 3)) + g.slide_drift[t];
    }
    change[0] = -madd(g.k_inverse[1], slip[1], g.k_inverse[0] * slip[0]);
    change[1] = -madd(g.k_inverse[2], slip[1], g.k_inverse[1] * slip[0]);
    r::clip(g.slide, change, g.friction * pressure, added);
    for (int t = 0; t < 2; ++t) {
      r::subtract(a, added[t] * g.root_a, g.tangent[t]), r::add(b, added[t] * g.root_b, g.tangent[t]);
      r::subtract(a + 3, added[t], g.tja[t]), r::add(b + 3, added[t], g.tjb[t]);
    }
  }
}
/// What every point should have for a relative velocity, negated; what is apart may close in one substep.
template <ContactSolve kind, class T>
Wide<T> wanted(const Wide<T>& s, const ContactPass<T>& pass) {
  using W = Wide<T>;
  if constexpr (kind == ContactSolve::push) {
    return where_positive(s, s * W(pass.inverse_h), max(s * W(pass.bias_rate), W(-pass.push_out)));
  }
  return max(s, W(0)) * W(pass.inverse_h);
}

/// 0 where a relaxation has to leave a point alone, 1 elsewhere: what bounces is not slowed before it hits.
template <class T>
Wide<T> held_back(const ContactGroup<T>& g, int p) {
  const Wide<T> zero(0), one(1);
  const Wide<T> waits = where_positive(g.place[p].apart, where_positive(g.place[p].impulse, one, zero), one);
  return where_positive(g.restitution, waits, one);
}

/// All six ways in which a patch holds at once. Lanes where that would pull, slide or twist are left as they
/// are: 1 in `done` for the others.
template <ContactSolve kind, class T>
Wide<T> solve_patch(ContactGroup<T>& g, Wide<T> a[6], Wide<T> b[6], const ContactPass<T>& pass) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W slip[6], f[6] = {};
  slip[0] = g.root_b * r::dot(g.normal, b) - g.root_a * r::dot(g.normal, a) +
            (r::dot(g.cjb, b + 3) - r::dot(g.cja, a + 3));
  for (int t = 0; t < 2; ++t) {
    slip[1 + t] = g.root_b * r::dot(g.tangent[t], b) - g.root_a * r::dot(g.tangent[t], a) +
                  (r::dot(g.tjb[t], b + 3) - r::dot(g.tja[t], a + 3)) + g.slide_drift[t];
    slip[4 + t] = r::dot(g.rjb[t], b + 3) - r::dot(g.rja[t], a + 3);
  }
  slip[3] = r::dot(g.njb, b + 3) - r::dot(g.nja, a + 3) + g.twist_drift;
  W held[3] = {}, before(0);  // force and torques of the normal impulses
  for (int p = 0; p < g.points; ++p) {
    const auto& at = g.place[p];
    const W u = wanted<kind>(at.apart, pass) + at.drift;
    slip[0] = madd(at.share[0], u, slip[0]);
    slip[4] = madd(at.share[1], u, slip[4]), slip[5] = madd(at.share[2], u, slip[5]);
    held[0] += at.impulse;
    held[1] = madd(at.y, at.impulse, held[1]), held[2] = nmadd(at.x, at.impulse, held[2]);
  }
  for (int p = 0, at = 0; p < 6; ++p) {
    for (int q = 0; q < p; ++q, ++at) {
      f[p] = nmadd(g.inverse[at], slip[q], f[p]);
      f[q] = nmadd(g.inverse[at], slip[p], f[q]);
    }
    f[p] = nmadd(g.inverse[at], slip[p], f[p]), ++at;
  }
  if constexpr (kind == ContactSolve::push) {
    const int normal_rows[3] = {0, 4, 5};
    for (int e = 0; e < 3; ++e) {
      const int p = normal_rows[e];
      f[p] = W(pass.mass_scale) * f[p] - W(pass.impulse_scale) * held[e];
    }
  }
  // The force and torques that the points have to make, spread as evenly as can be without pulling.
  const W zero(0), one(1);
  W impulse[4], low(-1e30), high(1e30);
  before = held[0];
  for (int k = 0; k < 3; ++k) held[k] += f[k == 0 ? 0 : 3 + k];
  for (int p = 0; p < g.points; ++p) {
    const auto& at = g.place[p];
    impulse[p] = madd(at.share[2], held[2], madd(at.share[1], held[1], at.share[0] * held[0]));
    const W zeroed = -impulse[p] * at.per_spare;
    low = where_positive(at.per_spare, max(low, zeroed), low);
    high = where_positive(-at.per_spare, min(high, zeroed), high);
  }
  const W moved = min(max(zero, low), high);
  W least(1e30), pressure(0), torque(0);
  for (int p = 0; p < g.points; ++p) {
    const auto& at = g.place[p];
    impulse[p] = madd(moved, at.spare, impulse[p]);
    least = min(least, impulse[p]);
    impulse[p] = max(impulse[p], zero);
    pressure += impulse[p];
    torque = madd(g.lever[p], impulse[p], torque);
  }
  const W slide[2] = {g.slide[0] + f[1], g.slide[1] + f[2]}, twist = g.twist + f[3];
  // A push takes from the points what friction may still rely on.
  const W limit = g.friction * max(pressure, before);
  W done = where_positive(-least - W(1e-5) * pressure, zero, g.whole);
  if (kind == ContactSolve::relax && (g.flags & ContactGroup<T>::kBounces)) {
    for (int p = 0; p < g.points; ++p) {
      done = where_positive(g.point[p].inverse_k, done * held_back(g, p), done);
    }
  }
  done = where_positive(madd(slide[1], slide[1], slide[0] * slide[0]) - limit * limit, zero, done);
  done = where_positive(max(twist, -twist) - torque, zero, done);
  for (int p = 0; p < g.points; ++p) {
    g.place[p].impulse = where_positive(done, impulse[p], g.place[p].impulse);
  }
  for (int t = 0; t < 2; ++t) g.slide[t] = where_positive(done, slide[t], g.slide[t]);
  g.twist = where_positive(done, twist, g.twist);
  for (W& x : f) x = where_positive(done, x, zero);
  W push[3];
  for (int k = 0; k < 3; ++k) {
    push[k] = madd(f[2], g.tangent[1][k], madd(f[1], g.tangent[0][k], f[0] * g.normal[k]));
  }
  r::subtract(a, g.root_a, push), r::add(b, g.root_b, push);
  const W* ja[6] = {g.cja, g.tja[0], g.tja[1], g.nja, g.rja[0], g.rja[1]};
  const W* jb[6] = {g.cjb, g.tjb[0], g.tjb[1], g.njb, g.rjb[0], g.rjb[1]};
  for (int k = 0; k < 6; ++k) r::subtract(a + 3, f[k], ja[k]), r::add(b + 3, f[k], jb[k]);
  return done;
}

/// The points' normal impulses one after the other.
template <ContactSolve kind, class T>
void solve_points(ContactGroup<T>& g, Wide<T> a[6], Wide<T> b[6], const ContactPass<T>& pass) {
  using W = Wide<T>;
  namespace r = contact_rows;
  // The linear part of J v changes by the same number for all points.
  const W k = g.root_a * g.root_a + g.root_b * g.root_b, zero(0), one(1);
  W linear = g.root_b * r::dot(g.normal, b) - g.root_a * r::dot(g.normal, a), sum(0);
  for (int p = 0; p < g.points; ++p) {
    auto& q = g.point[p];
    auto& at = g.place[p];
    const W speed = linear + (r::dot(q.jb, b + 3) - r::dot(q.ja, a + 3)) + at.drift;
    const W& s = at.apart;
    W total;
    if constexpr (kind == ContactSolve::push) {
      const W mass = where_positive(s, one, W(pass.mass_scale));
      const W leak = where_positive(s, zero, W(pass.impulse_scale));
      total = at.impulse - q.inverse_k * mass * (speed + wanted<kind>(s, pass)) - leak * at.impulse;
    } else {
      total = nmadd(q.inverse_k, speed + wanted<kind>(s, pass), at.impulse);
      total = total * held_back(g, p);
    }
    total = max(total, zero);
    const W added = total - at.impulse;
    at.impulse = total;
    sum += added;
    linear = madd(k, added, linear);
    r::subtract(a + 3, added, q.ja), r::add(b + 3, added, q.jb);
  }
  r::subtract(a, sum * g.root_a, g.normal), r::add(b, sum * g.root_b, g.normal);
}
}  // namespace detail

/// How far apart (m) the points of a group are after the displacements `d`, `elapsed` s into the step.
template <class T>
void update_separations(ContactGroup<T>& g, const Record8<T>* d, T elapsed) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W da[6], db[6], turn[2];
  gather6(d, g.a, da), gather6(d, g.b, db);
  const W moved = g.root_b * r::dot(g.normal, db) - g.root_a * r::dot(g.normal, da) +
                  (r::dot(g.cjb, db + 3) - r::dot(g.cja, da + 3));
  for (int t = 0; t < 2; ++t) turn[t] = r::dot(g.rjb[t], db + 3) - r::dot(g.rja[t], da + 3);
  for (int p = 0; p < g.points; ++p) {
    auto& at = g.place[p];
    at.apart = madd(at.drift, W(elapsed), at.separation) + nmadd(at.x, turn[1], madd(at.y, turn[0], moved));
  }
}

/// One pass over a group: patches that hold at once, then the rows of those that do not.
template <ContactSolve kind, class T>
void solve_contacts(ContactGroup<T>& g, Record8<T>* v, const Record8<T>* d, uint32_t end,
                    const ContactPass<T>& pass) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W a[6], b[6];
  // A push starts where the last relaxation ended.
  if constexpr (kind == ContactSolve::relax) update_separations(g, d, pass.elapsed);
  gather6(v, g.a, a), gather6(v, g.b, b);
  bool rest = true;
  if (g.points > 2 && !(g.flags & ContactGroup<T>::kRolls)) {
    const W done = detail::solve_patch<kind>(g, a, b, pass);
    rest = any_below(done, g.filled);
    // A push gives up some of the normal impulses; without friction's word on that, bodies creep.
    if (kind == ContactSolve::push && !rest) detail::solve_friction(g, a, b);
  }
  if (rest) {
    // Friction is bounded by the normal impulses of the last relaxation, never by what a push leaves.
    if constexpr (kind == ContactSolve::push) detail::solve_friction(g, a, b);
    detail::solve_points<kind>(g, a, b, pass);
    if constexpr (kind == ContactSolve::relax) detail::solve_friction(g, a, b);
  }
  scatter6(v, g.a, end, a), scatter6(v, g.b, end, b);
}

}  // namespace truestep
