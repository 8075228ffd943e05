// Contacts of rigid bodies, as many side by side as lanes: rows J v >= 0 solved by sequential impulses within
// a manifold of up to four points, for the substeps of a soft step (Catto, "Solver2D", 2024).
//
// Bodies are in scaled variables in which every mass matrix is the identity: the record of body i is
//   (sqrt(m) v, S w)   with  S S = I,  S symmetric, in the world at the step's start,
// and likewise for displacements, so that one vector j = S^-1 (r x n) both reads and changes a turn:
//   J v = n . (v_b / sqrt(m_b) - v_a / sqrt(m_a)) + j_b . w_b - j_a . w_a,    K = 1/m_a + 1/m_b + j_a^2 +
//   j_b^2
// Friction acts at the points' centre of pressure: a vector in the tangent plane, clipped to the disc of
// radius mu sum(l), and a twist about the normal of at most mu sum(l_p |p - c|), which is what the points
// give when the body only spins. Rolling resistance is a vector of torques along the plane.
// Lanes that hold nothing have inverse K and impulses 0 and name the record `end`, which is never written.
#pragma once
#include "engine/math/wide.h"

namespace truestep {

/// Numbers of one substep's pass.
template <class T>
struct ContactPass {
  T inverse_h;      ///< 1/s
  T elapsed;        ///< s since the step's start, for surfaces that move by themselves
  T bias_rate;      ///< 1/s, share of a depth that is taken back
  T mass_scale;     ///< 1
  T impulse_scale;  ///< 1
  T push_out;       ///< m/s, fastest taking back
};

template <class T>
struct alignas(64) ContactGroup {
  using W = Wide<T>;
  static constexpr int kPoints = 4;

  uint32_t a[W::kLanes], b[W::kLanes];  ///< records, `end` for bodies that contacts do not move
  int points = 0;                       ///< most points of a lane
  enum : uint32_t { kBounces = 1, kRolls = 2, kDrifts = 4 };
  uint32_t flags = 0;

  W normal[3], root_a, root_b;  ///< 1/sqrt(m)
  struct Point {
    W ja[3], jb[3], separation, inverse_k, impulse, drift;
  } point[kPoints];
  W tangent[2][3], tja[2][3], tjb[2][3];  ///< friction's rows
  W k_inverse[3];                         ///< xx, xy, yy
  W friction, slide[2], slide_drift[2];   ///< coefficient, impulses, velocity of the surfaces themselves
  W nja[3], njb[3], twist_k, twist, twist_drift, lever[kPoints];
  // Read only where the flags ask for it.
  W most[kPoints], approach[kPoints], restitution;  ///< largest impulse, J v when it first pressed
  W rja[2][3], rjb[2][3], roll_k[3], roll[2], rolling;
};

/// One manifold per lane, as the narrow phase found it.
template <class T>
struct ContactLanes {
  using W = Wide<T>;
  W normal[3], arm[4][3], apart[3];  ///< points from a's centre; b's centre from a's
  W active[4], separation[4], impulse[4];
  W root_a, root_b, turn_a[6], turn_b[6];  ///< 1/sqrt(m); S^-1 as xx yy zz xy xz yz
  W friction, spinning, rolling, restitution;
  W slide[3], twist, roll[3];  ///< impulses of the last step in the world
  W surface[3],
      surface_turn[3];  ///< velocity at a's centre and spin of b's surface against a's by themselves
};

namespace contact_rows {

template <class W>
W dot(const W a[3], const W b[3]) {
  return madd(a[2], b[2], madd(a[1], b[1], a[0] * b[0]));
}
template <class W>
void cross(const W a[3], const W b[3], W out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1], out[1] = a[2] * b[0] - a[0] * b[2], out[2] = a[0] * b[1] - a[1] * b[0];
}
/// S a for a symmetric S.
template <class W>
void apply(const W s[6], const W a[3], W out[3]) {
  out[0] = madd(s[4], a[2], madd(s[3], a[1], s[0] * a[0]));
  out[1] = madd(s[5], a[2], madd(s[1], a[1], s[3] * a[0]));
  out[2] = madd(s[2], a[2], madd(s[5], a[1], s[4] * a[0]));
}
/// v += s j.
template <class W>
void add(W v[3], const W& s, const W j[3]) {
  for (int k = 0; k < 3; ++k) v[k] = madd(s, j[k], v[k]);
}
template <class W>
void subtract(W v[3], const W& s, const W j[3]) {
  for (int k = 0; k < 3; ++k) v[k] = nmadd(s, j[k], v[k]);
}
/// Two unit vectors across n (Duff et al. 2017, "Building an orthonormal basis, revisited").
template <class W>
void basis(const W n[3], W t[2][3]) {
  const W one(1), sign = where_positive(n[2], one, -one), a = -one / (sign + n[2]), b = n[0] * n[1] * a;
  t[0][0] = one + sign * n[0] * n[0] * a, t[0][1] = sign * b, t[0][2] = -sign * n[0];
  t[1][0] = b, t[1][1] = sign + n[1] * n[1] * a, t[1][2] = -n[1];
}
/// Inverse of ((xx, xy), (xy, yy)), zero where it is singular.
template <class W>
void invert(const W& xx, const W& xy, const W& yy, W out[3]) {
  const W det = xx * yy - xy * xy, inv = where_positive(det, W(1) / det, W(0));
  out[0] = yy * inv, out[1] = -xy * inv, out[2] = xx * inv;
}
/// Four points in a plane hold a body in one way too many: adding s (a1, a2, a3, a4) with sum(a) = 0 and
/// sum(a p) = 0 changes neither force nor torque. Chooses s so that the impulses are as equal as they can be;
/// left alone, they drift until some are zero, and a body on two points of four totters.
template <class W>
void spread_impulses(const W normal[3], const W arm[4][3], W impulse[4]) {
  const auto area = [&](int i, int j, int k) {
    W u[3], v[3], c[3];
    for (int e = 0; e < 3; ++e) u[e] = arm[j][e] - arm[i][e], v[e] = arm[k][e] - arm[i][e];
    cross(u, v, c);
    return dot(c, normal);
  };
  const W a[4] = {area(1, 2, 3), -area(0, 2, 3), area(0, 1, 3), -area(0, 1, 2)};
  const W size = madd(a[3], a[3], madd(a[2], a[2], madd(a[1], a[1], a[0] * a[0])));
  const W along = madd(a[3], impulse[3], madd(a[2], impulse[2], madd(a[1], impulse[1], a[0] * impulse[0])));
  const W s = where_positive(size, along / size, W(0));
  // No impulse below zero.
  W share(1);
  for (int p = 0; p < 4; ++p) {
    const W taken = s * a[p];
    share = min(share, where_positive(taken - impulse[p], impulse[p] / taken, W(1)));
  }
  for (int p = 0; p < 4; ++p) impulse[p] = max(nmadd(share * s, a[p], impulse[p]), W(0));
}
/// Two more impulses on top of `total`, clipped to the disc of radius `limit`; what was added.
template <class W>
void clip(W total[2], const W d[2], const W& limit, W added[2]) {
  const W x = total[0] + d[0], y = total[1] + d[1], length = sqrt(madd(y, y, x * x));
  const W share = where_positive(length - limit, limit / length, W(1));
  const W cx = x * share, cy = y * share;
  added[0] = cx - total[0], added[1] = cy - total[1];
  total[0] = cx, total[1] = cy;
}

}  // namespace contact_rows

/// Rows of a group from what the narrow phase found; g.a, g.b, g.points and g.flags are set by the caller.
template <class T>
void prepare_contacts(ContactGroup<T>& g, const ContactLanes<T>& in) {
  using W = Wide<T>;
  namespace r = contact_rows;
  const W zero(0), one(1);
  for (int k = 0; k < 3; ++k) g.normal[k] = in.normal[k];
  g.root_a = in.root_a, g.root_b = in.root_b;
  const W linear = in.root_a * in.root_a + in.root_b * in.root_b;
  const auto inverse = [&](const W& k) { return where_positive(k, one / k, zero); };
  const auto row = [&](const W arm[3], const W axis[3], W ja[3], W jb[3]) {
    W other[3], moment[3];
    r::cross(arm, axis, moment), r::apply(in.turn_a, moment, ja);
    for (int k = 0; k < 3; ++k) other[k] = arm[k] - in.apart[k];
    r::cross(other, axis, moment), r::apply(in.turn_b, moment, jb);
  };
  const auto drift = [&](const W arm[3], const W axis[3]) {
    W v[3];
    r::cross(in.surface_turn, arm, v);
    for (int k = 0; k < 3; ++k) v[k] += in.surface[k];
    return r::dot(v, axis);
  };
  const bool drifts = g.flags & ContactGroup<T>::kDrifts;

  W impulse[4] = {in.impulse[0], in.impulse[1], in.impulse[2], in.impulse[3]};
  if (g.points == 4) r::spread_impulses(in.normal, in.arm, impulse);
  W weight(0), center[3] = {};
  for (int p = 0; p < g.points; ++p) {
    auto& q = g.point[p];
    row(in.arm[p], in.normal, q.ja, q.jb);
    q.inverse_k = in.active[p] * inverse(linear + r::dot(q.ja, q.ja) + r::dot(q.jb, q.jb));
    q.separation = in.separation[p], q.impulse = impulse[p], g.most[p] = g.approach[p] = zero;
    q.drift = drifts ? drift(in.arm[p], in.normal) : zero;
    // Points share the pressure of the last step; all alike where there was none.
    const W w = madd(in.active[p], W(1e-12), impulse[p]);
    weight += w;
    r::add(center, w, in.arm[p]);
  }
  const W share = inverse(weight);
  for (W& c : center) c *= share;

  r::basis(in.normal, g.tangent);
  for (int t = 0; t < 2; ++t) row(center, g.tangent[t], g.tja[t], g.tjb[t]);
  r::invert(linear + r::dot(g.tja[0], g.tja[0]) + r::dot(g.tjb[0], g.tjb[0]),
            r::dot(g.tja[0], g.tja[1]) + r::dot(g.tjb[0], g.tjb[1]),
            linear + r::dot(g.tja[1], g.tja[1]) + r::dot(g.tjb[1], g.tjb[1]), g.k_inverse);
  for (W& k : g.k_inverse) k *= in.active[0];
  g.friction = in.friction;
  for (int t = 0; t < 2; ++t) {
    g.slide[t] = r::dot(in.slide, g.tangent[t]);
    g.slide_drift[t] = drifts ? drift(center, g.tangent[t]) : zero;
  }

  r::apply(in.turn_a, in.normal, g.nja), r::apply(in.turn_b, in.normal, g.njb);
  g.twist_k = in.active[0] * inverse(r::dot(g.nja, g.nja) + r::dot(g.njb, g.njb));
  g.twist = in.twist, g.twist_drift = drifts ? r::dot(in.surface_turn, in.normal) : zero;
  for (int p = 0; p < g.points; ++p) {
    W d[3];
    for (int k = 0; k < 3; ++k) d[k] = in.arm[p][k] - center[k];
    g.lever[p] = madd(in.friction, sqrt(r::dot(d, d)), in.spinning) * in.active[p];
  }
  g.restitution = in.restitution, g.rolling = in.rolling;
  if (g.flags & ContactGroup<T>::kRolls) {
    for (int t = 0; t < 2; ++t) {
      r::apply(in.turn_a, g.tangent[t], g.rja[t]), r::apply(in.turn_b, g.tangent[t], g.rjb[t]);
      g.roll[t] = r::dot(in.roll, g.tangent[t]);
    }
    r::invert(r::dot(g.rja[0], g.rja[0]) + r::dot(g.rjb[0], g.rjb[0]),
              r::dot(g.rja[0], g.rja[1]) + r::dot(g.rjb[0], g.rjb[1]),
              r::dot(g.rja[1], g.rja[1]) + r::dot(g.rjb[1], g.rjb[1]), g.roll_k);
    for (W& k : g.roll_k) k *= in.active[0];
  }
}

/// Adds every impulse of the group to the records (scaled velocities).
template <class T>
void apply_contacts(const ContactGroup<T>& g, Record8<T>* records, uint32_t end) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W a[6], b[6], sum(0);
  gather6(records, g.a, a), gather6(records, g.b, b);
  for (int p = 0; p < g.points; ++p) {
    const auto& q = g.point[p];
    sum += q.impulse;
    r::subtract(a + 3, q.impulse, q.ja), r::add(b + 3, q.impulse, q.jb);
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

enum class ContactSolve : uint8_t {
  push,  ///< depths are taken back
  relax  ///< velocities only: takes out what `push` put in
};

namespace detail {
/// Rolling, twist and slide of a group, for the normal impulses as they are.
template <class T>
void solve_friction(ContactGroup<T>& g, Wide<T> a[6], Wide<T> b[6]) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W pressure(0), torque(0);
  for (int p = 0; p < g.points; ++p) {
    pressure += g.point[p].impulse;
    torque = madd(g.lever[p], g.point[p].impulse, torque);
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
}  // namespace detail

/// One pass over a group. `d` are the scaled displacements since the step's start.
template <ContactSolve kind, class T>
void solve_contacts(ContactGroup<T>& g, Record8<T>* v, const Record8<T>* d, uint32_t end,
                    const ContactPass<T>& pass) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W a[6], b[6];
  W separation[4];
  {
    W da[6], db[6];
    gather6(d, g.a, da), gather6(d, g.b, db);
    const W linear = g.root_b * r::dot(g.normal, db) - g.root_a * r::dot(g.normal, da);
    for (int p = 0; p < g.points; ++p) {
      const auto& q = g.point[p];
      separation[p] = madd(q.drift, W(pass.elapsed), q.separation) + linear +
                      (r::dot(q.jb, db + 3) - r::dot(q.ja, da + 3));
    }
  }
  gather6(v, g.a, a), gather6(v, g.b, b);

  // Friction is bounded by the normal impulses of the last relaxation, never by what a push leaves.
  if constexpr (kind == ContactSolve::push) detail::solve_friction(g, a, b);
  // The linear part of J v changes by the same number for all points.
  const W k = g.root_a * g.root_a + g.root_b * g.root_b;
  W linear = g.root_b * r::dot(g.normal, b) - g.root_a * r::dot(g.normal, a), sum(0);
  for (int p = 0; p < g.points; ++p) {
    auto& q = g.point[p];
    const W speed = linear + (r::dot(q.jb, b + 3) - r::dot(q.ja, a + 3)) + q.drift;
    const W& s = separation[p];
    W total;
    if constexpr (kind == ContactSolve::push) {
      // What comes in while nothing presses yet is what bounces.
      g.approach[p] = where_positive(q.impulse, g.approach[p], min(g.approach[p], speed));
      const W bias = where_positive(s, s * W(pass.inverse_h), max(s * W(pass.bias_rate), W(-pass.push_out)));
      const W mass = where_positive(s, W(1), W(pass.mass_scale));
      const W leak = where_positive(s, W(0), W(pass.impulse_scale));
      total = q.impulse - q.inverse_k * mass * (speed + bias) - leak * q.impulse;
    } else {
      const W bias = max(s, W(0)) * W(pass.inverse_h);
      total = nmadd(q.inverse_k, speed + bias, q.impulse);
    }
    total = max(total, W(0));
    const W added = total - q.impulse;
    q.impulse = total;
    sum += added;
    linear = madd(k, added, linear);
    r::subtract(a + 3, added, q.ja), r::add(b + 3, added, q.jb);
  }
  if (g.flags & ContactGroup<T>::kBounces) {
    for (int p = 0; p < g.points; ++p) g.most[p] = max(g.most[p], g.point[p].impulse);
  }
  r::subtract(a, sum * g.root_a, g.normal), r::add(b, sum * g.root_b, g.normal);
  if constexpr (kind == ContactSolve::relax) detail::solve_friction(g, a, b);
  scatter6(v, g.a, end, a), scatter6(v, g.b, end, b);
}

/// Gives points that pressed and came in faster than `threshold` (m/s) their share of that speed back.
template <class T>
void bounce_contacts(ContactGroup<T>& g, Record8<T>* v, uint32_t end, T threshold) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W a[6], b[6];
  gather6(v, g.a, a), gather6(v, g.b, b);
  const W k = g.root_a * g.root_a + g.root_b * g.root_b;
  W linear = g.root_b * r::dot(g.normal, b) - g.root_a * r::dot(g.normal, a), sum(0);
  for (int p = 0; p < g.points; ++p) {
    auto& q = g.point[p];
    const W speed = linear + (r::dot(q.jb, b + 3) - r::dot(q.ja, a + 3)) + q.drift;
    W total = max(nmadd(q.inverse_k, madd(g.restitution, g.approach[p], speed), q.impulse), W(0));
    total = where_positive(-g.approach[p] - W(threshold), total, q.impulse);
    total = where_positive(g.most[p] * g.restitution, total, q.impulse);
    const W added = total - q.impulse;
    q.impulse = total;
    sum += added;
    linear = madd(k, added, linear);
    r::subtract(a + 3, added, q.ja), r::add(b + 3, added, q.jb);
  }
  r::subtract(a, sum * g.root_a, g.normal), r::add(b, sum * g.root_b, g.normal);
  scatter6(v, g.a, end, a), scatter6(v, g.b, end, b);
}

}  // namespace truestep
