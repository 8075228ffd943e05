// Joints of rigid bodies, as many side by side as lanes: up to six locked ways of moving, solved at once. The
// rows lie along three axes fixed in body a,
//   linear  e_k . (x_b + r_b - x_a - r_a) = 0,      angular  e_k . (turn of b against a) = 0,
// in the scaled variables of contact_rows3.h; a row that is not locked has K = 1 and takes nothing. The arms
// turn with the bodies within a step, so that what swings fast stays together.
#pragma once
#include "engine/kernels/contact_rows3.h"

namespace truestep {

template <class T>
struct alignas(64) JointGroup {
  using W = Wide<T>;
  uint32_t a[W::kLanes], b[W::kLanes];  ///< records, `end` for what joints do not move
  W root_a, root_b, turn_a[9], turn_b[9];
  W arm_a[3], arm_b[3], error[3];  ///< m, at the step's start; error = x_b + r_b - x_a - r_a
  W axis[3][3], angle[3];          ///< e_k, turn of b against a about them (rad) at the step's start
  W locked[6];                     ///< 1 or 0: linear, angular
  W impulse[6];
  W strength;  ///< 1, or 0 when the lane holds nothing
  // Made anew in every substep.
  W ja[6][3], jb[6][3], gap[6], inverse[21];
};

namespace detail {
/// r after a turn by the rotation vector t, to second order: r + t x r + t x (t x r) / 2.
template <class W>
void turn_arm(const W t[3], const W r[3], W out[3]) {
  W once[3], twice[3];
  contact_rows::cross(t, r, once), contact_rows::cross(t, once, twice);
  for (int k = 0; k < 3; ++k) out[k] = madd(W(0.5), twice[k], r[k] + once[k]);
}
}  // namespace detail

/// Rows, gaps and the inverse of K where the bodies are now; d: scaled displacements since the step's start.
template <class T>
void prepare_joints(JointGroup<T>& g, const Record8<T>* d) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W da[6], db[6], ta[3], tb[3], arm_a[3], arm_b[3], gap[3], turn[3];
  gather6(d, g.a, da), gather6(d, g.b, db);
  r::apply_transposed(g.turn_a, da + 3, ta), r::apply_transposed(g.turn_b, db + 3, tb);
  detail::turn_arm(ta, g.arm_a, arm_a), detail::turn_arm(tb, g.arm_b, arm_b);
  for (int k = 0; k < 3; ++k) {
    gap[k] =
        g.error[k] + (g.root_b * db[k] + arm_b[k] - g.arm_b[k]) - (g.root_a * da[k] + arm_a[k] - g.arm_a[k]);
    turn[k] = tb[k] - ta[k];
  }
  const W linear = g.root_a * g.root_a + g.root_b * g.root_b;
  // Into the bodies' frames as they have turned by now.
  const W back_a[3] = {-ta[0], -ta[1], -ta[2]}, back_b[3] = {-tb[0], -tb[1], -tb[2]};
  const auto into = [](const W turn[9], const W back[3], const W world[3], W out[3]) {
    W start[3];
    detail::turn_arm(back, world, start), r::apply(turn, start, out);
  };
  for (int k = 0; k < 3; ++k) {
    W moment[3];
    r::cross(arm_a, g.axis[k], moment), into(g.turn_a, back_a, moment, g.ja[k]);
    r::cross(arm_b, g.axis[k], moment), into(g.turn_b, back_b, moment, g.jb[k]);
    into(g.turn_a, back_a, g.axis[k], g.ja[3 + k]), into(g.turn_b, back_b, g.axis[k], g.jb[3 + k]);
    g.gap[k] = r::dot(g.axis[k], gap);
    g.gap[3 + k] = g.angle[k] + r::dot(g.axis[k], turn);
  }
  W k[6][6];
  for (int p = 0; p < 6; ++p) {
    for (int q = 0; q <= p; ++q) {
      k[p][q] = g.locked[p] * g.locked[q] * (r::dot(g.ja[p], g.ja[q]) + r::dot(g.jb[p], g.jb[q]));
    }
    if (p < 3) k[p][p] = madd(g.locked[p], linear, k[p][p]);
    k[p][p] = madd(k[p][p], W(1e-6), k[p][p]) + (W(1) - g.locked[p]);
  }
  r::invert_positive<6>(k, g.inverse);
}

namespace detail {
template <class T>
void push_joint(const JointGroup<T>& g, const Wide<T> f[6], Wide<T> a[6], Wide<T> b[6]) {
  using W = Wide<T>;
  namespace r = contact_rows;
  for (int k = 0; k < 3; ++k) {
    r::subtract(a, f[k] * g.root_a, g.axis[k]), r::add(b, f[k] * g.root_b, g.axis[k]);
  }
  for (int k = 0; k < 6; ++k) r::subtract(a + 3, f[k], g.ja[k]), r::add(b + 3, f[k], g.jb[k]);
}
}  // namespace detail

/// Adds `times` the group's impulses to the records (scaled velocities).
template <class T>
void apply_joints(const JointGroup<T>& g, Record8<T>* records, uint32_t end, T times) {
  Wide<T> a[6], b[6], f[6];
  gather6(records, g.a, a), gather6(records, g.b, b);
  for (int k = 0; k < 6; ++k) f[k] = Wide<T>(times) * g.impulse[k];
  detail::push_joint(g, f, a, b);
  scatter6(records, g.a, end, a), scatter6(records, g.b, end, b);
}

/// One pass: velocities, and with `push` gaps too, by the coefficients of soft_constraint.h.
template <ContactSolve kind, class T>
void solve_joints(JointGroup<T>& g, Record8<T>* v, uint32_t end, T bias_rate, T mass_scale, T impulse_scale) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W a[6], b[6], slip[6], f[6] = {};
  gather6(v, g.a, a), gather6(v, g.b, b);
  for (int k = 0; k < 6; ++k) {
    slip[k] = r::dot(g.jb[k], b + 3) - r::dot(g.ja[k], a + 3);
    if (k < 3) slip[k] += g.root_b * r::dot(g.axis[k], b) - g.root_a * r::dot(g.axis[k], a);
    if constexpr (kind == ContactSolve::push) slip[k] = madd(W(bias_rate), g.gap[k], slip[k]);
    slip[k] *= g.locked[k];
  }
  for (int p = 0, at = 0; p < 6; ++p) {
    for (int q = 0; q < p; ++q, ++at) {
      f[p] = nmadd(g.inverse[at], slip[q], f[p]);
      f[q] = nmadd(g.inverse[at], slip[p], f[q]);
    }
    f[p] = nmadd(g.inverse[at], slip[p], f[p]), ++at;
  }
  for (int k = 0; k < 6; ++k) {
    if constexpr (kind == ContactSolve::push) {
      f[k] = W(mass_scale) * f[k] - W(impulse_scale) * g.impulse[k];
    }
    g.impulse[k] += f[k];
  }
  detail::push_joint(g, f, a, b);
  scatter6(v, g.a, end, a), scatter6(v, g.b, end, b);
}

}  // namespace truestep
