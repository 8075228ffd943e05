// Contacts of rigid bodies, one manifold per lane: rows J v >= 0 solved by sequential impulses within a
// manifold of up to four points, in the substeps of a step with soft constraints (Catto, "Solver2D", 2024).
//
// Bodies are in scaled variables in which every mass matrix is the identity: the record of body i is
//   (sqrt(m) v, sqrt(I) R^T w),     I the principal moments, R the orientation,
// and likewise for displacements, so that one vector j = S (r x n), S = I^-1/2 R^T, serves both to read and
// to change an angular velocity. Angular quantities are in the body's frame, where inertia is constant. A
// pass works in the frame of the contact: axes n, t0, t1 at the points' centre of pressure c. Of a body it
// needs S n, S t0, S t1 and the position of c: with r = (rn, r0, r1) from the body's centre to c and the
// angular velocity w = (wn, w0, w1) along the axes, c moves at w x r, and a force f at c has the torque r x
// f. Six numbers describe the motion of b relative to a,
//   v = (velocity of c along n, t0, t1, angular velocity about n, t0, t1);
// impulses f of the same six kinds change them by K f and are applied to both bodies once, at the end of the
// pass. A point at c + x t0 + y t1 moves at v0 + y v4 - x v5 along n. Friction acts at the centre of
// pressure: a vector in the tangent plane, clipped to the disc of radius mu sum(l), and a torsional impulse
// about the normal of at most mu sum(l_p |p - c|), which is what friction at the points gives when the body
// only spins. Rolling resistance is a vector of angular impulses in the tangent plane. Empty lanes have
// inverse K and impulses 0 and refer to the record `end`, which is never written.
#pragma once
#include "engine/kernels/rigid/row_math3.h"

namespace truestep {

/// Parameters of a pass in one substep.
template <class T>
struct ContactPass {
  T inverse_h;      ///< 1/s
  T elapsed;        ///< s since the start of the step, for surfaces with a velocity of their own
  T bias_rate;      ///< 1/s, rate at which penetration is recovered
  T mass_scale;     ///< 1
  T impulse_scale;  ///< 1
  T push_out;       ///< m/s, upper bound of the velocity that recovers penetration
  T gentle;         ///< m/s; bodies that are pushed apart faster do not keep that velocity
  const Record8<T>* start = nullptr;  ///< scaled velocities before the pushes; set if some exceed `gentle`
};

template <class T>
struct alignas(64) ContactGroup {
  using W = Wide<T>;
  static constexpr int kPoints = 4;

  uint32_t a[W::kLanes], b[W::kLanes];  ///< record indices; `end` for bodies that contacts do not move
  int points = 0;                       ///< largest number of points of any lane
  enum : uint32_t { kBounces = 1, kRolls = 2, kDrifts = 4, kSpins = 8, kTurns = 16 };
  uint32_t flags = 0;

  W normal[3], tangent[2][3], root_a, root_b;  ///< axes; 1/sqrt(m)
  struct Body {
    W axis[3][3];  ///< S n, S t0, S t1
    W arm[3];      ///< m, from the body's centre to c along n, t0, t1
  } body_a, body_b;
  struct Place {
    W x, y;                             ///< m from c along the tangents
    W separation_at_start, separation;  ///< m, at the start of the step and now
    W impulse, drift;
  } place[kPoints];
  W friction, slide[2], slide_drift[2];  ///< coefficient, impulses, velocity of moving surfaces
  W twist, twist_drift, lever[kPoints];
  W k[21];                            ///< K, lower triangle by rows
  W point_inverse[kPoints];           ///< inverse of K for a point's normal; 0 where there is no point
  W slide_inverse[3], twist_inverse;  ///< inverse of K for friction: xx, xy, yy
  W struck;                           ///< 1 where an impact is being shared by the points
  // Read only if the flags require it.
  W restitution;
  W slide_rate[2];    ///< m/s^2, change of slide_drift in the step
  W lift, lift_rate;  ///< m/s along the normal at the start of the step, m/s^2: of surfaces that turn
  W roll_k[3], roll[2], rolling;
  // Written only in substeps with deep penetration.
  struct Before {
    W taken;  ///< 1 in lanes whose push is removed from the velocities afterwards
    W impulse[kPoints], slide[2], twist, roll[2];
  } before;
};

/// One manifold per lane, as the narrow phase found it.
template <class T>
struct ContactLanes {
  using W = Wide<T>;
  W normal[3], arm[4][3], offset[3];  ///< points from a's centre; b's centre from a's
  W active[4], separation[4], impulse[4];
  W kept[4];  ///< m/s along n: velocity of b's surface minus that of its material, less the same for a
  W root_a, root_b, turn_a[9], turn_b[9];  ///< 1/sqrt(m); S by rows
  W friction, spinning, rolling, restitution;
  W slide[3], twist, roll[3];                 ///< impulses of the last step, in the world
  W turn;                                     ///< rad/s about n, of b relative to a
  W surface[3], carried[3], carried_rate[3],  ///< m/s, m/s^2 (carried_contact.h), at the start of the step
      lift, lift_rate,                        ///< the same along the normal
      lies,                                   ///< 1 where a face turns along with the face it lies on
      surface_turn[3];  ///< velocity at a's centre and angular velocity of b's moving surface relative to a's
};

namespace detail {
/// The six rows of a body's angular part: j such that j . w is its contribution to v.
template <class Body, class W>
void body_rows(const Body& body, W j[6][3]) {
  const auto& [n, t, u] = body.axis;
  const W &rn = body.arm[0], &rt = body.arm[1], &ru = body.arm[2];
  for (int k = 0; k < 3; ++k) {
    j[0][k] = ru * t[k] - rt * u[k], j[1][k] = rn * u[k] - ru * n[k], j[2][k] = rt * n[k] - rn * t[k];
    j[3][k] = n[k], j[4][k] = t[k], j[5][k] = u[k];
  }
}
}  // namespace detail

/// K and its inverses from the masses, axes and points of a group; active[p]: 1 where a lane has point p.
template <class T>
void weigh(ContactGroup<T>& g, const Wide<T> active[4]) {
  using W = Wide<T>;
  namespace r = contact_rows;
  const W linear = g.root_a * g.root_a + g.root_b * g.root_b;
  const auto inverse = [](const W& k) { return where_positive(k, W(1) / k, W(0)); };
  W ja[6][3], jb[6][3], k[6][6];
  detail::body_rows(g.body_a, ja), detail::body_rows(g.body_b, jb);
  for (int p = 0, at = 0; p < 6; ++p) {
    for (int q = 0; q <= p; ++q, ++at) {
      k[p][q] = r::dot(ja[p], ja[q]) + r::dot(jb[p], jb[q]);
      if (p < 3 && p == q) k[p][p] += linear;
      g.k[at] = k[p][q];
    }
  }
  for (int p = 0; p < g.points; ++p) {
    const W &x = g.place[p].x, &y = g.place[p].y;
    const W along = k[0][0] + y * (k[4][0] + k[4][0] + y * k[4][4]) - x * (k[5][0] + k[5][0] - x * k[5][5]) -
                    (x + x) * y * k[5][4];
    g.point_inverse[p] = active[p] * inverse(along);
  }
  r::invert(k[1][1], k[2][1], k[2][2], g.slide_inverse);
  for (W& s : g.slide_inverse) s *= active[0];
  g.twist_inverse = active[0] * inverse(k[3][3]);
  if (!(g.flags & ContactGroup<T>::kRolls)) return;
  r::invert(k[4][4], k[5][4], k[5][5], g.roll_k);
  for (W& s : g.roll_k) s *= active[0];
}

/// Divides the masses of the bodies a and b by the squares of fa and fb; their records then hold velocities
/// times the root of the new mass. Powers of two change no other bits and can be undone.
template <class T>
void lighten(ContactGroup<T>& g, const Wide<T>& fa, const Wide<T>& fb) {
  using W = Wide<T>;
  g.root_a *= fa, g.root_b *= fb;
  for (auto& axis : g.body_a.axis) {
    for (W& s : axis) s *= fa;
  }
  for (auto& axis : g.body_b.axis) {
    for (W& s : axis) s *= fb;
  }
  W active[ContactGroup<T>::kPoints];
  for (int p = 0; p < g.points; ++p) active[p] = where_positive(g.point_inverse[p], W(1), W(0));
  weigh(g, active);
}

/// Rows of a group from the manifolds in `in`; g.a, g.b, g.points and g.flags are set by the caller.
template <class T>
void prepare_contacts(ContactGroup<T>& g, const ContactLanes<T>& in) {
  using W = Wide<T>;
  namespace r = contact_rows;
  const W zero(0), one(1);
  for (int k = 0; k < 3; ++k) g.normal[k] = in.normal[k];
  r::basis(in.normal, g.tangent);
  g.root_a = in.root_a, g.root_b = in.root_b;
  const auto inverse = [&](const W& k) { return where_positive(k, one / k, zero); };
  const auto drift = [&](const W arm[3], const W axis[3]) {
    W v[3];
    r::cross(in.surface_turn, arm, v);
    for (int k = 0; k < 3; ++k) v[k] += in.surface[k];
    return r::dot(v, axis);
  };
  const bool drifts = g.flags & ContactGroup<T>::kDrifts;

  W weight(0), center[3] = {}, half(0), nearest(T(1e30));
  for (int p = 0; p < g.points; ++p) {
    auto& at = g.place[p];
    at.separation_at_start = at.separation = in.separation[p], at.impulse = in.impulse[p];
    at.drift = drifts ? drift(in.arm[p], in.normal) + in.kept[p] : in.kept[p];
    // Weights of the centre of pressure: the impulses of the last step, or equal ones if there were none.
    const W w = madd(in.active[p], W(1e-12), in.impulse[p]);
    nearest = min(nearest, where_positive(in.active[p], in.separation[p], nearest));
    weight += w;
    r::add(center, w, in.arm[p]);
    half = madd(w, W(T(0.5)) * max(in.separation[p], zero), half);
  }
  const W share = inverse(weight);
  for (W& c : center) c *= share;

  // Loaded though still apart: the last step slowed the bodies so that they arrive in this one.
  g.struck = where_positive(nearest, one, zero);

  // Friction acts where the surfaces will meet, half of the gap away from each. What turns along with what it
  // lies on has no gap: that of points found ahead is their way there.
  half *= share * (one - in.lies);
  const W* axes[3] = {g.normal, g.tangent[0], g.tangent[1]};
  W from_b[3];
  for (int k = 0; k < 3; ++k) from_b[k] = center[k] - in.offset[k];
  for (int k = 0; k < 3; ++k) {
    r::apply(in.turn_a, axes[k], g.body_a.axis[k]), r::apply(in.turn_b, axes[k], g.body_b.axis[k]);
    g.body_a.arm[k] = r::dot(center, axes[k]), g.body_b.arm[k] = r::dot(from_b, axes[k]);
  }
  g.body_a.arm[0] -= half, g.body_b.arm[0] += half;

  for (int p = 0; p < g.points; ++p) {
    W d[3];
    for (int k = 0; k < 3; ++k) d[k] = (in.arm[p][k] - center[k]) * in.active[p];
    g.place[p].x = r::dot(d, g.tangent[0]), g.place[p].y = r::dot(d, g.tangent[1]);
    g.lever[p] = madd(in.friction, sqrt(r::dot(d, d)), in.spinning) * in.active[p];
  }
  weigh(g, in.active);
  // Friction about the normal does not stop the spin within the first substep: it slips.
  W torque(0);
  for (int p = 0; p < g.points; ++p) torque = madd(g.lever[p], in.impulse[p], torque);
  if (any_below(torque, g.twist_inverse * max(in.turn, -in.turn))) g.flags |= ContactGroup<T>::kSpins;
  g.friction = in.friction;
  for (int t = 0; t < 2; ++t) {
    g.slide[t] = r::dot(in.slide, g.tangent[t]);
    g.slide_drift[t] = drifts ? drift(center, g.tangent[t]) + r::dot(in.carried, g.tangent[t]) : zero;
  }
  if (g.flags & ContactGroup<T>::kTurns) {
    for (int t = 0; t < 2; ++t) g.slide_rate[t] = r::dot(in.carried_rate, g.tangent[t]);
    g.lift = in.lift, g.lift_rate = in.lift_rate;
  }
  g.twist = in.twist, g.twist_drift = drifts ? r::dot(in.surface_turn, in.normal) : zero;
  g.restitution = in.restitution, g.rolling = in.rolling;
  if (g.flags & ContactGroup<T>::kRolls) {
    for (int t = 0; t < 2; ++t) g.roll[t] = r::dot(in.roll, g.tangent[t]);
  }
}

}  // namespace truestep
