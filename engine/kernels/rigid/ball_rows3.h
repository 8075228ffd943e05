// Ball joints of rigid bodies, one joint per lane: the anchors on a and b stay together,
//   J v = v_b + w_b x r_b - v_a - w_a x r_a = 0      (three rows along the world's axes),
// in the scaled variables of contact_rows3.h. With s_j the rows of S, a body's scaled spin w moves its anchor
// at sum_j w_j (s_j x r), so the three vectors c_j = s_j x r are all that a pass reads of it, and
//   K = 1/m_a + 1/m_b + sum_j c_j c_j^T      over both bodies.
// They turn with the bodies after every move; impulses keep their direction in the world. The bias pass
// anticipates that each anchor moves on an arc about its body's centre, t x (t x r) / 2 away from the
// straight path while the body turns by t in a substep: a swing then keeps its energy, and only what this
// estimate misses, because it is one substep old, is left as a gap to be taken back.
#pragma once
#include "engine/kernels/rigid/joint_rows3.h"

namespace truestep {

template <class T>
struct alignas(64) BallGroup {
  using W = Wide<T>;
  uint32_t a[W::kLanes], b[W::kLanes];  ///< record indices; `end` for bodies that joints do not move
  W root_a, root_b;                     ///< 1/sqrt(m)
  W arm_a[3], arm_b[3], gap[3];         ///< m; gap = x_b + r_b - x_a - r_a
  W spin_a[3][3], spin_b[3][3];         ///< c_j: velocity of the anchor per unit of the scaled spin j
  W bend[3];                            ///< m, change of the gap in a substep because anchors move on arcs
  W inverse[6];                         ///< of K: xx, xy, yy, xz, yz, zz
  W impulse[3];                         ///< N s on b, in the world
  W strength;                           ///< 1, or 0 in an empty lane
};

namespace detail {
/// Inverse of K for the current vectors c_j.
template <class T>
void invert_ball(BallGroup<T>& g) {
  using W = Wide<T>;
  const W linear = madd(g.root_a, g.root_a, g.root_b * g.root_b) + (W(1) - g.strength);
  W k[6] = {linear, W(0), linear, W(0), W(0), linear};
  for (int j = 0; j < 3; ++j) {
    for (const W* c : {g.spin_a[j], g.spin_b[j]}) {
      k[0] = madd(c[0], c[0], k[0]), k[1] = madd(c[0], c[1], k[1]), k[2] = madd(c[1], c[1], k[2]);
      k[3] = madd(c[0], c[2], k[3]), k[4] = madd(c[1], c[2], k[4]), k[5] = madd(c[2], c[2], k[5]);
    }
  }
  const W xx = nmadd(k[4], k[4], k[2] * k[5]), xy = nmadd(k[1], k[5], k[3] * k[4]);
  const W xz = nmadd(k[2], k[3], k[1] * k[4]);
  const W scale = g.strength / madd(k[3], xz, madd(k[1], xy, k[0] * xx));
  g.inverse[0] = xx * scale, g.inverse[1] = xy * scale, g.inverse[3] = xz * scale;
  g.inverse[2] = nmadd(k[3], k[3], k[0] * k[5]) * scale;
  g.inverse[4] = nmadd(k[0], k[4], k[1] * k[3]) * scale;
  g.inverse[5] = nmadd(k[1], k[1], k[0] * k[2]) * scale;
}

/// Applies the impulse f to b and -f to a.
template <class T>
void push_ball(const BallGroup<T>& g, const Wide<T> f[3], Wide<T> a[6], Wide<T> b[6]) {
  namespace r = contact_rows;
  r::subtract(a, g.root_a, f), r::add(b, g.root_b, f);
  for (int j = 0; j < 3; ++j) {
    a[3 + j] -= r::dot(g.spin_a[j], f);
    b[3 + j] += r::dot(g.spin_b[j], f);
  }
}
}  // namespace detail

/// Applies the group's accumulated impulses to the records (scaled velocities).
template <class T>
void apply_balls(const BallGroup<T>& g, Record8<T>* records, uint32_t end) {
  Wide<T> a[6], b[6];
  gather6(records, g.a, a), gather6(records, g.b, b);
  detail::push_ball(g, g.impulse, a, b);
  scatter6(records, g.a, end, a), scatter6(records, g.b, end, b);
}

/// Updates the group after the bodies have moved (m) and turned (rad, in the world) by `moved`; `warm` holds
/// the warm-start impulses of all joints.
template <Renewal renewal, class T>
void renew_balls(BallGroup<T>& g, const Record8<T>* moved, Record8<T>* warm, uint32_t end) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W a[6], b[6], wa[6], wb[6];
  gather6(moved, g.a, a), gather6(moved, g.b, b);
  const detail::Turn<W> turn_a(a + 3), turn_b(b + 3);
  const auto turn = [](const detail::Turn<W>& by, W x[3]) {
    W out[3];
    by.apply(x, out);
    for (int k = 0; k < 3; ++k) x[k] = out[k];
  };
  if constexpr (renewal == Renewal::last) {
    for (int j = 0; j < 3; ++j) turn(turn_a, g.spin_a[j]), turn(turn_b, g.spin_b[j]);
    return detail::invert_ball(g);
  }
  gather6(warm, g.a, wa), gather6(warm, g.b, wb);
  for (int k = 0; k < 3; ++k) g.gap[k] += (b[k] - a[k]) + (g.arm_a[k] - g.arm_b[k]);
  turn(turn_a, g.arm_a), turn(turn_b, g.arm_b);
  for (int k = 0; k < 3; ++k) g.gap[k] += g.arm_b[k] - g.arm_a[k];
  detail::bend_gap(a + 3, g.arm_a, b + 3, g.arm_b, g.bend);
  for (int j = 0; j < 3; ++j) {
    wa[3 + j] += r::dot(g.spin_a[j], g.impulse), wb[3 + j] -= r::dot(g.spin_b[j], g.impulse);
    turn(turn_a, g.spin_a[j]), turn(turn_b, g.spin_b[j]);
    wa[3 + j] -= r::dot(g.spin_a[j], g.impulse), wb[3 + j] += r::dot(g.spin_b[j], g.impulse);
  }
  detail::invert_ball(g);
  scatter6(warm, g.a, end, wa), scatter6(warm, g.b, end, wb);
}

/// One pass: velocities only, or the gaps as well in a bias pass.
template <ContactSolve kind, class T>
void solve_balls(BallGroup<T>& g, Record8<T>* v, uint32_t end, const JointPass<T>& pass) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W a[6], b[6], slip[3], f[3];
  gather6(v, g.a, a), gather6(v, g.b, b);
  for (int k = 0; k < 3; ++k) {
    slip[k] = nmadd(g.root_a, a[k], g.root_b * b[k]);
    if constexpr (kind == ContactSolve::bias) {
      slip[k] = madd(W(pass.inverse_h), g.bend[k], madd(W(pass.bias_rate), g.gap[k], slip[k]));
    }
  }
  for (int j = 0; j < 3; ++j) r::add(slip, b[3 + j], g.spin_b[j]), r::subtract(slip, a[3 + j], g.spin_a[j]);
  const W* k = g.inverse;
  f[0] = -madd(k[3], slip[2], madd(k[1], slip[1], k[0] * slip[0]));
  f[1] = -madd(k[4], slip[2], madd(k[2], slip[1], k[1] * slip[0]));
  f[2] = -madd(k[5], slip[2], madd(k[4], slip[1], k[3] * slip[0]));
  for (int e = 0; e < 3; ++e) {
    if constexpr (kind == ContactSolve::bias) {
      f[e] = nmadd(W(pass.impulse_scale), g.impulse[e], W(pass.mass_scale) * f[e]);
    }
    g.impulse[e] += f[e];
  }
  detail::push_ball(g, f, a, b);
  scatter6(v, g.a, end, a), scatter6(v, g.b, end, b);
}

}  // namespace truestep
