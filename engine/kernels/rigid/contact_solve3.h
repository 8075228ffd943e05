// Passes over groups of contacts (contact_rows3.h), row by row: the normal impulses of the points one after
// the other, and friction for the current normal impulses. Solving the six rows of a patch as one block
// converges faster but never comes to rest: the active set of a block flips whenever a point separates or
// friction starts to slip.
#pragma once
#include <limits>

#include "engine/kernels/rigid/contact_rows3.h"

namespace truestep {

namespace detail {
/// Angular velocity of a body along the axes of the contact.
template <class Body, class W>
[[gnu::always_inline]] inline void turns_along(const Body& body, const W turn[3], W out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = contact_rows::dot(body.axis[k], turn);
}

/// Motion of b relative to a: the six numbers v from the bodies' records.
template <class T>
[[gnu::always_inline]] inline void relative_motion(const ContactGroup<T>& g, const Wide<T> a[6],
                                                   const Wide<T> b[6], Wide<T> v[6]) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W linear[3], wa[3], wb[3];
  for (int k = 0; k < 3; ++k) linear[k] = nmadd(g.root_a, a[k], g.root_b * b[k]);
  turns_along(g.body_a, a + 3, wa), turns_along(g.body_b, b + 3, wb);
  const W *ra = g.body_a.arm, *rb = g.body_b.arm;
  const W* axes[3] = {g.normal, g.tangent[0], g.tangent[1]};
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    v[k] = r::dot(linear, axes[k]) + nmadd(wb[j], rb[i], wb[i] * rb[j]) - nmadd(wa[j], ra[i], wa[i] * ra[j]);
    v[3 + k] = wb[k] - wa[k];
  }
}

/// Applies the impulses f at c to b's record and -f to a's.
template <class T>
[[gnu::always_inline]] inline void push_apart(const ContactGroup<T>& g, const Wide<T> f[6], Wide<T> a[6],
                                              Wide<T> b[6]) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W push[3];
  for (int k = 0; k < 3; ++k) {
    push[k] = madd(f[2], g.tangent[1][k], madd(f[1], g.tangent[0][k], f[0] * g.normal[k]));
  }
  r::subtract(a, g.root_a, push), r::add(b, g.root_b, push);
  const W *ra = g.body_a.arm, *rb = g.body_b.arm;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    r::subtract(a + 3, f[3 + k] + nmadd(ra[j], f[i], ra[i] * f[j]), g.body_a.axis[k]);
    r::add(b + 3, f[3 + k] + nmadd(rb[j], f[i], rb[i] * f[j]), g.body_b.axis[k]);
  }
}

/// Index of an element of K in its lower triangle.
constexpr int at(int row, int column) {
  return row > column ? row * (row + 1) / 2 + column : column * (column + 1) / 2 + row;
}

/// Adds one impulse of kind `which` to f and updates v.
template <class T>
[[gnu::always_inline]] inline void add_impulse(const ContactGroup<T>& g, int which, const Wide<T>& impulse,
                                               Wide<T> v[6], Wide<T> f[6]) {
  f[which] += impulse;
  for (int k = 0; k < 6; ++k) v[k] = madd(g.k[at(k, which)], impulse, v[k]);
}

/// Fraction of the sideways stopping impulse that friction may apply while the surfaces spin on one another
/// (ContactGroup::kSpins: where the friction of their spin slips, however slowly they turn).
/// Slipping at the speed s then changes the friction of points that move at w r by no more than s / (w r):
/// sideways friction is a drag, slide = -most s / (w r), taken implicitly. The full impulse at a centre of
/// pressure off the axis would drive a body that spins on the spot round in circles.
template <class T>
Wide<T> grip(const ContactGroup<T>& g, const Wide<T> v[6], const Wide<T>& torque, const Wide<T>& most) {
  using W = Wide<T>;
  const W one(1), turn = v[3] + g.twist_drift, mass = W(T(0.5)) * (g.slide_inverse[0] + g.slide_inverse[2]);
  // 1 / (1 + mass w r / most), where r = torque / most.
  const W r = torque / most, held = mass * max(turn, -turn) * r / most;
  return where_positive(most, one / (one + held), one);
}

/// The inverse of K for sliding where the friction of the spin, after it, stops what the sliding has turned
/// the bodies by: both are then solved at once. Where that friction is at its limit `torque`, slide_inverse.
template <class T>
void slide_with_twist(const ContactGroup<T>& g, const Wide<T>& torque, Wide<T> out[3]) {
  using W = Wide<T>;
  const W &x = g.k[at(3, 1)], &y = g.k[at(3, 2)];
  const W follows = where_positive(torque - max(g.twist, -g.twist), g.twist_inverse, W(0)), fx = follows * x;
  W both[3];
  contact_rows::invert(nmadd(fx, x, g.k[at(1, 1)]), nmadd(fx, y, g.k[at(2, 1)]),
                       nmadd(follows * y, y, g.k[at(2, 2)]), both);
  for (int k = 0; k < 3; ++k) out[k] = where_positive(follows, both[k], g.slide_inverse[k]);
}

/// Rolling, torsional and sliding friction of a group for the current normal impulses; `time`: s since the
/// start of the step.
template <class T>
void solve_friction(ContactGroup<T>& g, Wide<T> v[6], Wide<T> f[6], T time) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W pressure(0), torque(0);
  for (int p = 0; p < g.points; ++p) {
    pressure += g.place[p].impulse;
    torque = madd(g.lever[p], g.place[p].impulse, torque);
  }
  if (g.flags & ContactGroup<T>::kRolls) {
    W change[2], added[2];
    change[0] = -madd(g.roll_k[1], v[5], g.roll_k[0] * v[4]);
    change[1] = -madd(g.roll_k[2], v[5], g.roll_k[1] * v[4]);
    r::clip(g.roll, change, g.rolling * pressure, added);
    for (int t = 0; t < 2; ++t) add_impulse(g, 4 + t, added[t], v, f);
  }
  const auto twist = [&] {
    const W speed = v[3] + g.twist_drift;
    const W total = max(min(nmadd(g.twist_inverse, speed, g.twist), torque), -torque);
    const W added = total - g.twist;
    g.twist = total;
    add_impulse(g, 3, added, v, f);
  };
  twist();
  {
    W slip[2], change[2], added[2], inverse[3] = {g.slide_inverse[0], g.slide_inverse[1], g.slide_inverse[2]};
    for (int t = 0; t < 2; ++t) slip[t] = v[1 + t] + g.slide_drift[t];
    if (g.flags & ContactGroup<T>::kTurns) {
      for (int t = 0; t < 2; ++t) slip[t] = madd(g.slide_rate[t], W(time), slip[t]);
      slide_with_twist(g, torque, inverse);
    }
    change[0] = -madd(inverse[1], slip[1], inverse[0] * slip[0]);
    change[1] = -madd(inverse[2], slip[1], inverse[1] * slip[0]);
    const W most = g.friction * pressure;
    if (g.flags & ContactGroup<T>::kSpins) {
      const W lost = W(1) - grip(g, v, torque, most);
      for (int t = 0; t < 2; ++t) change[t] = nmadd(lost, g.slide[t] + change[t], change[t]);
    }
    r::clip(g.slide, change, most, added);
    for (int t = 0; t < 2; ++t) add_impulse(g, 1 + t, added[t], v, f);
  }
  // What goes round is pulled sideways anew in every substep, and where that acts beside its centre it would
  // turn on its table by a little in each: its spin is stopped last, and sliding is solved with that in view,
  // or it would creep along with what is left of it.
  if (g.flags & ContactGroup<T>::kTurns) twist();
}
/// The relative velocity that a point should have, negated. Separated points may close their gap within one
/// substep.
template <ContactSolve kind, class T>
Wide<T> wanted(const Wide<T>& s, const ContactPass<T>& pass, const Wide<T>& push_out) {
  using W = Wide<T>;
  if constexpr (kind == ContactSolve::bias) {
    return where_positive(s, s * W(pass.inverse_h), max(s * W(pass.bias_rate), -push_out));
  }
  return max(s, W(0)) * W(pass.inverse_h);
}

/// Velocity (m/s) with which a pair may still be pushed apart: a body that penetrates many others must not
/// accumulate a full push from each.
template <class T>
Wide<T> push_left(const ContactGroup<T>& g, const Wide<T> a[6], const Wide<T> b[6],
                  const ContactPass<T>& pass) {
  using W = Wide<T>;
  W a0[6], b0[6], ea(0), eb(0);
  gather6(pass.start, g.a, a0), gather6(pass.start, g.b, b0);
  for (int k = 0; k < 6; ++k) {
    const W da = a[k] - a0[k], db = b[k] - b0[k];
    ea = madd(da, da, ea), eb = madd(db, db, eb);
  }
  const W gained = madd(g.root_a, sqrt(ea), g.root_b * sqrt(eb));
  return max(nmadd(W(T(1.2)), gained, W(pass.push_out)), W(0));
}

/// 0 for a point that the relaxation must leave alone, 1 otherwise: a contact that will bounce is not slowed
/// before it hits.
template <class T>
Wide<T> held_back(const ContactGroup<T>& g, int p) {
  const Wide<T> zero(0), one(1);
  const Wide<T> waits =
      where_positive(g.place[p].separation, where_positive(g.place[p].impulse, one, zero), one);
  return where_positive(g.restitution, waits, one);
}

/// Multiple of the scalar's epsilon, times the speed of an impact, up to which a load is the rounding of a
/// gap that closes exactly at the end of a substep: separations are sums over at most some ten substeps.
inline constexpr int kRoundedGap = 64;

/// An impact: points that carried no load yet, or only the rounding of a gap, and that all approach share the
/// impulse that stops the slowest of them, and share what later passes add to it or take back. Solved one
/// after the other, the first point would take the whole impulse and turn the body, which a few passes cannot
/// undo.
template <ContactSolve kind, class T>
void share_blow(ContactGroup<T>& g, Wide<T> v[6], Wide<T> f[6], const ContactPass<T>& pass,
                const Wide<T>& push_out) {
  using W = Wide<T>;
  const W zero(0), one(1), far(T(1e30)), &k00 = g.k[at(0, 0)];
  W pressure(0);
  for (int p = 0; p < g.points; ++p) pressure += g.place[p].impulse;
  // Skipped where the centre of the points does not approach.
  const W closes = where_positive(-v[0], where_positive(k00, one, zero), zero);
  const W rounding = W(kRoundedGap * std::numeric_limits<T>::epsilon());
  const W loaded = madd(pressure, k00, rounding * min(v[0], zero));
  const W shares = where_positive(loaded, g.struck, closes);
  if (!any_below(-shares, zero)) return;
  W least = far, most = -far, weakest = far, count(0);
  for (int p = 0; p < g.points; ++p) {
    const auto& place = g.place[p];
    const W speed = nmadd(place.x, v[5], madd(place.y, v[4], v[0])) + place.drift;
    const W closing = -(speed + wanted<kind>(place.separation, pass, push_out));
    W share = where_positive(place.separation, one, W(pass.mass_scale));
    if constexpr (kind == ContactSolve::relax) share = held_back(g, p);
    least = min(least, where_positive(g.point_inverse[p], share * closing, far));
    most = max(most, where_positive(g.point_inverse[p], share * closing, -far));
    weakest = min(weakest, where_positive(g.point_inverse[p], place.impulse, far));
    count += where_positive(g.point_inverse[p], one, zero);
  }
  const W stop = where_positive(least, least, min(most, zero)) / max(k00 * count, W(T(1e-30)));
  const W each = where_positive(shares, max(stop, -weakest), zero);
  g.struck = where_positive(each * each, one, zero);
  W sum[3] = {};
  for (int p = 0; p < g.points; ++p) {
    auto& place = g.place[p];
    const W added = where_positive(g.point_inverse[p], each, zero);
    place.impulse += added;
    sum[0] += added, sum[1] = madd(place.y, added, sum[1]), sum[2] = nmadd(place.x, added, sum[2]);
  }
  add_impulse(g, 0, sum[0], v, f), add_impulse(g, 4, sum[1], v, f), add_impulse(g, 5, sum[2], v, f);
}

/// Normal impulses of the points, one after the other.
template <ContactSolve kind, class T>
void solve_points(ContactGroup<T>& g, Wide<T> v[6], Wide<T> f[6], const ContactPass<T>& pass,
                  const Wide<T>& push_out) {
  using W = Wide<T>;
  const W zero(0), one(1);
  // The impulse of a point is one along n and two about the tangents; only those affect the other points.
  const W k00 = g.k[at(0, 0)], k40 = g.k[at(4, 0)], k50 = g.k[at(5, 0)], k44 = g.k[at(4, 4)],
          k54 = g.k[at(5, 4)], k55 = g.k[at(5, 5)];
  W sum[3] = {};
  for (int p = 0; p < g.points; ++p) {
    auto& place = g.place[p];
    const W &x = place.x, &y = place.y, &s = place.separation;
    const W speed = nmadd(x, v[5], madd(y, v[4], v[0])) + place.drift;
    W total;
    if constexpr (kind == ContactSolve::bias) {
      const W mass = where_positive(s, one, W(pass.mass_scale));
      const W leak = where_positive(s, zero, W(pass.impulse_scale));
      total = place.impulse - g.point_inverse[p] * mass * (speed + wanted<kind>(s, pass, push_out)) -
              leak * place.impulse;
    } else {
      total = nmadd(g.point_inverse[p], speed + wanted<kind>(s, pass, push_out), place.impulse);
      total = total * held_back(g, p);
    }
    total = max(total, zero);
    const W added = total - place.impulse, about = y * added, around = x * added;
    place.impulse = total;
    sum[0] += added, sum[1] += about, sum[2] -= around;
    v[0] += nmadd(k50, around, madd(k40, about, k00 * added));
    v[4] += nmadd(k54, around, madd(k44, about, k40 * added));
    v[5] += nmadd(k55, around, madd(k54, about, k50 * added));
  }
  f[0] += sum[0], f[4] += sum[1], f[5] += sum[2];
  for (int k = 1; k < 4; ++k) {
    v[k] += madd(g.k[at(k, 5)], sum[2], madd(g.k[at(k, 4)], sum[1], g.k[at(k, 0)] * sum[0]));
  }
}
}  // namespace detail

/// Separations (m) of the points of a group after the displacements `d`, `elapsed` s into the step.
template <class T>
[[gnu::always_inline]] inline void update_separations(ContactGroup<T>& g, const Record8<T>* d, T elapsed) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W da[6], db[6], v[6];
  gather6(d, g.a, da), gather6(d, g.b, db);
  detail::relative_motion(g, da, db, v);
  if (g.flags & ContactGroup<T>::kTurns) {
    v[0] = madd(W(elapsed), madd(g.lift_rate, W(T(0.5) * elapsed), g.lift), v[0]);
  }
  for (int p = 0; p < g.points; ++p) {
    auto& at = g.place[p];
    at.separation =
        madd(at.drift, W(elapsed), at.separation_at_start) + nmadd(at.x, v[5], madd(at.y, v[4], v[0]));
  }
}

/// One pass over a group of contacts.
template <ContactSolve kind, class T>
void solve_contacts(ContactGroup<T>& g, Record8<T>* records, const Record8<T>* d, uint32_t end,
                    const ContactPass<T>& pass) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W a[6], b[6], v[6], f[6] = {};
  // A bias pass starts from the separations of the last relaxation.
  if constexpr (kind == ContactSolve::relax) update_separations(g, d, pass.elapsed);
  gather6(records, g.a, a), gather6(records, g.b, b);
  detail::relative_motion(g, a, b, v);
  // A push leads to the end of a substep, by the mean of its velocities.
  const T time = kind == ContactSolve::bias ? pass.elapsed + T(0.5) / pass.inverse_h : pass.elapsed;
  if (g.flags & ContactGroup<T>::kTurns) v[0] += madd(g.lift_rate, W(time), g.lift);
  W push_out(pass.push_out);
  if (kind == ContactSolve::bias && pass.start) push_out = detail::push_left(g, a, b, pass);
  // Friction is bounded by the normal impulses of the last relaxation, never by those of a push.
  if constexpr (kind == ContactSolve::bias) detail::solve_friction(g, v, f, time);
  detail::share_blow<kind>(g, v, f, pass, push_out);
  detail::solve_points<kind>(g, v, f, pass, push_out);
  if constexpr (kind == ContactSolve::relax) {
    detail::solve_friction(g, v, f, time);
  } else if ((g.flags & ContactGroup<T>::kTurns) && !pass.start) {
    // What goes round is pulled sideways anew in every substep: what the normals leave of its slip adds up.
    detail::solve_friction(g, v, f, time);
  }
  detail::push_apart(g, f, a, b);
  scatter6(records, g.a, end, a), scatter6(records, g.b, end, b);
}

/// Negative in lanes that penetrate so deeply that the push would exceed `gentle`, unless the depth is what
/// their load causes: holding that takes an equally fast push.
template <class T>
Wide<T> depth_left(const ContactGroup<T>& g, const ContactPass<T>& pass) {
  using W = Wide<T>;
  W least(T(1e30)), load(0);
  for (int p = 0; p < g.points; ++p) {
    const W left = madd(g.place[p].separation, W(pass.bias_rate), W(pass.gentle));
    least = min(least, left * g.point_inverse[p]);
    load += g.place[p].impulse;
  }
  return madd(load, W(2 * pass.impulse_scale / pass.mass_scale), least);
}

/// Saves the impulses before a push that will be removed afterwards.
template <class T>
void remember_impulses(ContactGroup<T>& g) {
  for (int p = 0; p < g.points; ++p) g.before.impulse[p] = g.place[p].impulse;
  for (int t = 0; t < 2; ++t) g.before.slide[t] = g.slide[t], g.before.roll[t] = g.roll[t];
  g.before.twist = g.twist;
}

/// Removes from the records what a push has added since remember_impulses, in lanes where `taken` is 1: the
/// bodies have moved by it but do not keep the velocity.
template <class T>
void take_push_back(ContactGroup<T>& g, Record8<T>* records, uint32_t end) {
  using W = Wide<T>;
  const W& taken = g.before.taken;
  W a[6], b[6], f[6] = {};
  gather6(records, g.a, a), gather6(records, g.b, b);
  const auto back = [&](W& now, const W& before) {
    const W change = taken * (before - now);
    now += change;
    return change;
  };
  for (int p = 0; p < g.points; ++p) {
    auto& at = g.place[p];
    const W change = back(at.impulse, g.before.impulse[p]);
    f[0] += change;
    f[4] = madd(at.y, change, f[4]), f[5] = nmadd(at.x, change, f[5]);
  }
  for (int t = 0; t < 2; ++t) f[1 + t] = back(g.slide[t], g.before.slide[t]);
  f[3] = back(g.twist, g.before.twist);
  if (g.flags & ContactGroup<T>::kRolls) {
    for (int t = 0; t < 2; ++t) f[4 + t] += back(g.roll[t], g.before.roll[t]);
  }
  detail::push_apart(g, f, a, b);
  scatter6(records, g.a, end, a), scatter6(records, g.b, end, b);
}

/// Applies the accumulated impulses of the group to the records (scaled velocities).
template <class T>
void apply_contacts(const ContactGroup<T>& g, Record8<T>* records, uint32_t end) {
  using W = Wide<T>;
  W a[6], b[6], f[6] = {W(0), g.slide[0], g.slide[1], g.twist, W(0), W(0)};
  gather6(records, g.a, a), gather6(records, g.b, b);
  for (int p = 0; p < g.points; ++p) {
    const auto& at = g.place[p];
    f[0] += at.impulse;
    f[4] = madd(at.y, at.impulse, f[4]), f[5] = nmadd(at.x, at.impulse, f[5]);
  }
  if (g.flags & ContactGroup<T>::kRolls) f[4] += g.roll[0], f[5] += g.roll[1];
  detail::push_apart(g, f, a, b);
  scatter6(records, g.a, end, a), scatter6(records, g.b, end, b);
}

}  // namespace truestep
