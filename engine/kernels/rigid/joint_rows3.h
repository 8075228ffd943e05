// Joints of rigid bodies, one joint per lane: up to six rows along axes that turn with body a, of which the
// locked ones are solved together. In the scaled variables of contact_rows3.h,
//   linear  e_k . (x_b + r_b - x_a - r_a) = 0,      angular  t_k . (rotation of b relative to a) = 0;
// a row that is not locked has K = 1 and takes no impulse. Forces on a act at b's anchor, so that sliding
// joints conserve angular momentum. Arms and axes turn with the bodies within a step, so that fast swings
// stay together; rotations are measured about the axes halfway. Rows that are not locked: joint_drives3.h.
#pragma once
#include "engine/kernels/rigid/row_math3.h"

namespace truestep {

template <class T>
struct alignas(64) JointGroup {
  using W = Wide<T>;
  uint32_t a[W::kLanes], b[W::kLanes];  ///< record indices; `end` for bodies that joints do not move
  W root_a, root_b, turn_a[9], turn_b[9];
  W arm_a[3], arm_b[3], error[3];  ///< m, at the start of the step; error = x_b + r_b - x_a - r_a
  W axis[3][3], turn_axis[3][3];   ///< e_k, t_k at the start of the step
  W angle[3];                      ///< angular errors at the start of the step, rad
  W locked[6];                     ///< 1 or 0: linear, angular
  W drift[6];                      ///< J v due to bodies with prescribed motion
  /// rad in the world, rotations since the start of the step as of the last prepare
  W turned_a[3], turned_b[3];
  W along, length;  ///< 1 if the first row lies along the line between the anchors; its rest length, m
  W impulse[6];
  W bound[2];  ///< N s, N m s: bounds of the joint impulse of the motors in rows 0 to 2 and 3 to 5
  /// kTurns: angular rows are used; kSprings: a drive has a spring.
  enum : uint32_t { kLines = 1, kDrifts = 2, kBounded = 4, kTurns = 8, kSprings = 16 };
  uint32_t flags = 0;
  uint32_t driven_rows = 0;              ///< bits
  uint32_t first_drive = 0, drives = 0;  ///< in the solver's list
  // Recomputed in every substep.
  W now[3][3], turn_now[3][3];  ///< axes
  W ja[6][3], jb[6][3], gap[6], inverse[21];
};

/// Coefficients of soft_constraint.h for one pass.
template <class T>
struct JointPass {
  T bias_rate = 0, mass_scale = 1, impulse_scale = 0;
  T inverse_h = 0;  ///< 1/s, one over the substep
};

namespace detail {
/// A rotation by the vector t:  r + A t x r + B t x (t x r)  with A = sin|t| / |t| and B = (1 - cos|t|) / t^2
/// (Rodrigues), their series accurate to 1e-7 at 1 rad and 2e-3 at 3.
template <class W>
struct Turn {
  W t[3], once, twice;
  explicit Turn(const W rotation[3]) {
    for (int k = 0; k < 3; ++k) t[k] = rotation[k];
    const W s = contact_rows::dot(t, t);
    once = nmadd(s, nmadd(s, nmadd(s, W(1.0 / 5040), W(1.0 / 120)), W(1.0 / 6)), W(1));
    twice = nmadd(s, nmadd(s, nmadd(s, W(1.0 / 40320), W(1.0 / 720)), W(1.0 / 24)), W(0.5));
  }
  void apply(const W r[3], W out[3]) const { add(once, r, out); }
  void apply_back(const W r[3], W out[3]) const { add(-once, r, out); }

 private:
  void add(const W& first, const W r[3], W out[3]) const {
    W a[3], b[3];
    contact_rows::cross(t, r, a), contact_rows::cross(t, a, b);
    for (int k = 0; k < 3; ++k) out[k] = madd(twice, b[k], madd(first, a[k], r[k]));
  }
};
/// m, second-order deviation of the anchors from their straight paths when the bodies turn on by t, b's less
/// a's.
template <class W>
[[gnu::always_inline]] inline void bend_gap(const W ta[3], const W arm_a[3], const W tb[3], const W arm_b[3],
                                            W out[3]) {
  W once[3], a[3], b[3];
  contact_rows::cross(ta, arm_a, once), contact_rows::cross(ta, once, a);
  contact_rows::cross(tb, arm_b, once), contact_rows::cross(tb, once, b);
  for (int k = 0; k < 3; ++k) out[k] = W(0.5) * (b[k] - a[k]);
}
}  // namespace detail

/// Rows, position errors and the inverse of K at the bodies' present poses; d: scaled displacements since the
/// start of the step, which was `elapsed` s ago.
template <int rows, class T>
void prepare_joint_rows(JointGroup<T>& g, const Record8<T>* d, T elapsed) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W da[6], db[6], ta[3], tb[3], half[3], arm_a[3], arm_b[3], gap[3], turn[3];
  gather6(d, g.a, da), gather6(d, g.b, db);
  r::apply_transposed(g.turn_a, da + 3, ta), r::apply_transposed(g.turn_b, db + 3, tb);
  const detail::Turn<W> turn_a(ta), turn_b(tb);
  turn_a.apply(g.arm_a, arm_a), turn_b.apply(g.arm_b, arm_b);
  for (int k = 0; k < 3; ++k) {
    gap[k] =
        g.error[k] + (g.root_b * db[k] + arm_b[k] - g.arm_b[k]) - (g.root_a * da[k] + arm_a[k] - g.arm_a[k]);
    turn[k] = tb[k] - ta[k], half[k] = W(0.5) * ta[k];
  }
  for (int k = 0; k < 3; ++k) g.turned_a[k] = ta[k], g.turned_b[k] = tb[k];
  // From a's centre to b's anchor.
  for (int k = 0; k < 3; ++k) arm_a[k] += gap[k];
  const W linear = g.root_a * g.root_a + g.root_b * g.root_b;
  // Into the bodies' frames at their present rotation.
  const auto into = [](const W scaled[9], const detail::Turn<W>& turn, const W world[3], W out[3]) {
    W start[3];
    turn.apply_back(world, start), r::apply(scaled, start, out);
  };
  for (int k = 0; k < 3; ++k) turn_a.apply(g.axis[k], g.now[k]);
  const detail::Turn<W> half_way(half);
  if (g.flags & JointGroup<T>::kLines) {
    const W length = sqrt(r::dot(gap, gap)), inverse = W(1) / max(length, W(1e-12));
    for (int k = 0; k < 3; ++k) {
      const W line = where_positive(length - W(1e-9), gap[k] * inverse, g.axis[0][k]);
      g.now[0][k] = where_positive(g.along, line, g.now[0][k]);
    }
  }
  for (int k = 0; k < 3; ++k) {
    W moment[3], between[3];
    r::cross(arm_a, g.now[k], moment), into(g.turn_a, turn_a, moment, g.ja[k]);
    r::cross(arm_b, g.now[k], moment), into(g.turn_b, turn_b, moment, g.jb[k]);
    g.gap[k] = r::dot(g.now[k], gap);
    if constexpr (rows == 3) continue;
    turn_a.apply(g.turn_axis[k], g.turn_now[k]), half_way.apply(g.turn_axis[k], between);
    into(g.turn_a, turn_a, g.turn_now[k], g.ja[3 + k]), into(g.turn_b, turn_b, g.turn_now[k], g.jb[3 + k]);
    g.gap[3 + k] = g.angle[k] + r::dot(between, turn);
  }
  g.gap[0] = nmadd(g.along, g.length, g.gap[0]);
  if (g.flags & JointGroup<T>::kDrifts) {
    for (int k = 0; k < rows; ++k) g.gap[k] = madd(W(elapsed), g.drift[k], g.gap[k]);
  }
  W k[rows][rows];
  for (int p = 0; p < rows; ++p) {
    for (int q = 0; q <= p; ++q) {
      k[p][q] = g.locked[p] * g.locked[q] * (r::dot(g.ja[p], g.ja[q]) + r::dot(g.jb[p], g.jb[q]));
    }
    if (p < 3) k[p][p] = madd(g.locked[p], linear, k[p][p]);
    k[p][p] = madd(k[p][p], W(1e-6), k[p][p]) + (W(1) - g.locked[p]);
  }
  r::invert_positive<rows>(k, g.inverse);
}
template <class T>
void prepare_joints(JointGroup<T>& g, const Record8<T>* d, T elapsed) {
  if (g.flags & JointGroup<T>::kTurns) {
    prepare_joint_rows<6>(g, d, elapsed);
  } else {
    prepare_joint_rows<3>(g, d, elapsed);
  }
}

namespace detail {
template <int rows, class T>
[[gnu::always_inline]] inline void push_joint(const JointGroup<T>& g, const Wide<T> f[6], Wide<T> a[6],
                                              Wide<T> b[6]) {
  namespace r = contact_rows;
  for (int k = 0; k < 3; ++k) {
    r::subtract(a, f[k] * g.root_a, g.now[k]), r::add(b, f[k] * g.root_b, g.now[k]);
  }
  for (int k = 0; k < rows; ++k) r::subtract(a + 3, f[k], g.ja[k]), r::add(b + 3, f[k], g.jb[k]);
}
/// J v of a row.
template <class T>
Wide<T> joint_speed(const JointGroup<T>& g, int k, const Wide<T> a[6], const Wide<T> b[6]) {
  namespace r = contact_rows;
  Wide<T> v = r::dot(g.jb[k], b + 3) - r::dot(g.ja[k], a + 3);
  if (k < 3) v += g.root_b * r::dot(g.now[k], b) - g.root_a * r::dot(g.now[k], a);
  return v + g.drift[k];
}

/// m, deviation of the anchors from their straight paths in a substep h at the bodies' present angular
/// velocities (ball_rows3.h): the rotation of the previous substep would lag behind the springs' effect and
/// add energy.
template <class T>
[[gnu::always_inline]] inline void bend_ahead(const JointGroup<T>& g, const Wide<T> a[6], const Wide<T> b[6],
                                              const Wide<T>& h, Wide<T> out[3]) {
  using W = Wide<T>;
  namespace r = contact_rows;
  const auto round = [&](const W turn[9], const W spin[3], const W arm[3], const W turned[3], W bent[3]) {
    W t[3], once[3], twice[3];
    r::apply_transposed(turn, spin, t), r::cross(t, arm, once), r::cross(t, once, twice);
    Turn<W>(turned).apply(twice, bent);
  };
  W bent_a[3], bent_b[3];
  round(g.turn_a, a + 3, g.arm_a, g.turned_a, bent_a), round(g.turn_b, b + 3, g.arm_b, g.turned_b, bent_b);
  const W half = W(0.5) * h * h;
  for (int k = 0; k < 3; ++k) out[k] = half * (bent_b[k] - bent_a[k]);
}

/// The locked rows of one pass.
template <ContactSolve kind, int rows, class T>
[[gnu::always_inline]] inline void solve_locked(JointGroup<T>& g, Wide<T> a[6], Wide<T> b[6],
                                                const JointPass<T>& pass) {
  using W = Wide<T>;
  W slip[rows], f[6] = {};
  W bend[3];
  if constexpr (kind == ContactSolve::bias) bend_ahead(g, a, b, W(1) / W(pass.inverse_h), bend);
  for (int k = 0; k < rows; ++k) {
    slip[k] = joint_speed(g, k, a, b);
    if constexpr (kind == ContactSolve::bias) {
      slip[k] = madd(W(pass.bias_rate), g.gap[k], slip[k]);
      if (k < 3) slip[k] = madd(W(pass.inverse_h), contact_rows::dot(g.now[k], bend), slip[k]);
    }
    slip[k] *= g.locked[k];
  }
  for (int p = 0, at = 0; p < rows; ++p) {
    for (int q = 0; q < p; ++q, ++at) {
      f[p] = nmadd(g.inverse[at], slip[q], f[p]);
      f[q] = nmadd(g.inverse[at], slip[p], f[q]);
    }
    f[p] = nmadd(g.inverse[at], slip[p], f[p]), ++at;
  }
  for (int k = 0; k < rows; ++k) {
    if constexpr (kind == ContactSolve::bias) {
      f[k] = W(pass.mass_scale) * f[k] - W(pass.impulse_scale) * g.impulse[k];
    }
    g.impulse[k] += f[k];
  }
  push_joint<rows>(g, f, a, b);
}
}  // namespace detail

}  // namespace truestep
