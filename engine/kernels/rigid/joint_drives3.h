// Unlocked rows of joints with a limit, spring or motor, one scalar each. Their impulses act along
//   p = J_r^T - J_l^T (K_ll)^-1 K_lr
// (l: the locked rows of the same joint), which leaves the velocities of the locked rows unchanged, so that a
// motor on a hinge far from a body's centre turns the body about the hinge: 1 / (J_r p) is the inertia about
// that axis.
//   spring, servo, motor:  dl = -(scale (J v - speed) + push C) / k - pull C - (1 - scale) l,   |l| <= most
//   limits:                l >= 0,  speculative before C = 0 is reached (J v >= -C / h), soft once C < 0.
// The impulses of the motors of a pose are also kept within a ball over three rows.
#pragma once
#include "engine/kernels/rigid/joint_rows3.h"

namespace truestep {

template <class T>
struct alignas(64) JointDrive {
  using W = Wide<T>;
  int row = 0;
  enum Law : uint32_t { kSpring = 1, kMotor = 2, kLower = 4, kUpper = 8 };
  uint32_t laws = 0;  ///< of any lane
  W start;            ///< the row's position error at the start of the step
  /// A bilateral row. All zero in lanes without it.
  struct TwoSided {
    W error, speed, scale;
    W push;  ///< 1/s
    W pull;  ///< N s/m
    W most, impulse;
  } spring, motor;
  W moved;  ///< change of the error since the start of the step, as of the last bias pass
  W half;   ///< N s/m: impulse of half a kick of springs that alone act on their bodies (oscillator_step)
  /// A unilateral row with C at the start of the step. kFar in lanes without it.
  struct OneSided {
    W error, impulse;
  } lower, upper;
  static constexpr T kFar = T(1e20);
  // Recomputed in every substep.
  W share[6], k, inverse_k;  ///< p over the joint's rows, J_r p
};

/// Directions and effective masses of a drive of the group; call prepare_joints first.
template <class T>
void prepare_drive(const JointGroup<T>& g, JointDrive<T>& d) {
  using W = Wide<T>;
  namespace r = contact_rows;
  W k[6], c[6] = {};
  const int row = d.row;
  const W linear = g.root_a * g.root_a + g.root_b * g.root_b;
  for (int q = 0; q < 6; ++q) {
    k[q] = r::dot(g.ja[q], g.ja[row]) + r::dot(g.jb[q], g.jb[row]);
    if (q == row && q < 3) k[q] += linear;
  }
  // The line between the anchors is not perpendicular to the other two axes, but no joint locks these in
  // addition to a line.
  for (int p = 0, at = 0; p < 6; ++p) {
    for (int q = 0; q <= p; ++q, ++at) {
      c[p] = madd(g.inverse[at], g.locked[q] * k[q], c[p]);
      if (q < p) c[q] = madd(g.inverse[at], g.locked[p] * k[p], c[q]);
    }
  }
  d.k = k[row];
  for (int q = 0; q < 6; ++q) {
    c[q] *= g.locked[q];
    d.share[q] = q == row ? W(1) : -c[q];
    if (q != row) d.k = nmadd(c[q], k[q], d.k);
  }
  // A row that the locked rows hold completely has no motion left to drive.
  const W zero(0);
  d.inverse_k = where_positive(d.k - W(1e-6) * k[row], W(1) / d.k, zero);
}

namespace detail {
/// Change of a bilateral impulse towards `speed`; updates the row's velocity v.
template <class T>
Wide<T> two_sided(typename JointDrive<T>::TwoSided& s, const Wide<T>& speed, const Wide<T>& moved,
                  const JointDrive<T>& d, Wide<T>& v) {
  using W = Wide<T>;
  const W error = s.error + moved, wanted = madd(s.scale, v - speed, s.push * error);
  const W pulled = where_positive(d.inverse_k, s.pull * error, W(0));
  const W next = nmadd(d.inverse_k, wanted, s.scale * s.impulse) - pulled;
  const W clamped = max(-s.most, min(s.most, next)), change = clamped - s.impulse;
  s.impulse = clamped;
  v = madd(d.k, change, v);
  return change;
}
/// The same for a limit, with v the velocity away from it.
template <ContactSolve kind, class T>
Wide<T> one_sided(typename JointDrive<T>::OneSided& s, const Wide<T>& gap, const JointDrive<T>& d,
                  const JointPass<T>& pass, const Wide<T>& v) {
  using W = Wide<T>;
  const W zero(0), one(1);
  W rate(0), scale(1), back(0);
  if constexpr (kind == ContactSolve::bias) {
    rate = W(pass.bias_rate), scale = W(pass.mass_scale), back = W(pass.impulse_scale);
  }
  const W bias = where_positive(gap, gap * W(pass.inverse_h), gap * rate);
  scale = where_positive(gap, one, scale), back = where_positive(gap, zero, back);
  const W next = max(zero, s.impulse - d.inverse_k * scale * (v + bias) - back * s.impulse);
  const W change = next - s.impulse;
  s.impulse = next;
  return change;
}
template <class T>
void push_drive(const JointGroup<T>& g, const JointDrive<T>& d, const Wide<T>& change, Wide<T> a[6],
                Wide<T> b[6]) {
  Wide<T> f[6];
  for (int k = 0; k < 6; ++k) f[k] = change * d.share[k];
  push_joint<6>(g, f, a, b);
}
template <class T>
Wide<T> total_impulse(const JointDrive<T>& d) {
  return d.spring.impulse + d.motor.impulse + d.lower.impulse - d.upper.impulse;
}

template <ContactSolve kind, class T>
void solve_drive(const JointGroup<T>& g, JointDrive<T>& d, Wide<T> a[6], Wide<T> b[6],
                 const JointPass<T>& pass) {
  using W = Wide<T>;
  using D = JointDrive<T>;
  W v = joint_speed(g, d.row, a, b), sum(0);
  const W moved = g.gap[d.row] - d.start;
  // A spring's force in a substep is that at its start. A relaxation that used the positions after the bias
  // pass would apply another force than the one by which the bodies moved, and add energy to oscillations.
  if constexpr (kind == ContactSolve::bias) d.moved = moved;
  if (d.laws & D::kSpring) sum += two_sided<T>(d.spring, W(0), d.moved, d, v);
  if (d.laws & D::kMotor) {
    // A motor does not drive beyond its limits: motor and limit, both rigid, would work against each other.
    const W zero(0), up = (d.upper.error - moved) * W(pass.inverse_h),
                     down = (d.lower.error + moved) * W(pass.inverse_h);
    const W speed = max(-max(zero, down), min(max(zero, up), d.motor.speed));
    sum += two_sided<T>(d.motor, speed, d.moved, d, v);
  }
  if (d.laws & D::kLower) {
    const W change = one_sided<kind, T>(d.lower, d.lower.error + moved, d, pass, v);
    sum += change, v = madd(d.k, change, v);
  }
  if (d.laws & D::kUpper) sum -= one_sided<kind, T>(d.upper, d.upper.error - moved, d, pass, -v);
  push_drive(g, d, sum, a, b);
}

/// Keeps the motor impulses of rows first to first + 2 within the ball of radius `most`.
template <class T>
void bound_motors(const JointGroup<T>& g, JointDrive<T>* drives, int first, const Wide<T>& most, Wide<T> a[6],
                  Wide<T> b[6]) {
  using W = Wide<T>;
  W length2(1e-30);
  const auto each = [&](auto&& body) {
    for (uint32_t k = 0; k < g.drives; ++k) {
      if (drives[k].row >= first && drives[k].row < first + 3) body(drives[k]);
    }
  };
  each([&](const JointDrive<T>& d) { length2 = madd(d.motor.impulse, d.motor.impulse, length2); });
  const W length = sqrt(length2), change = where_positive(length - most, most / length - W(1), W(0));
  each([&](JointDrive<T>& d) {
    const W less = change * d.motor.impulse;
    d.motor.impulse += less;
    push_drive(g, d, less, a, b);
  });
}
}  // namespace detail

/// Applies `times` half a kick of the group's springs at their present extensions.
template <class T>
void kick_springs(const JointGroup<T>& g, const JointDrive<T>* drives, Record8<T>* v, uint32_t end, T times) {
  using W = Wide<T>;
  W a[6], b[6];
  gather6(v, g.a, a), gather6(v, g.b, b);
  for (uint32_t k = 0; k < g.drives; ++k) {
    const JointDrive<T>& d = drives[k];
    const W stretched = d.spring.error + (g.gap[d.row] - d.start);
    detail::push_drive(g, d, where_positive(d.inverse_k, W(-times) * d.half * stretched, W(0)), a, b);
  }
  scatter6(v, g.a, end, a), scatter6(v, g.b, end, b);
}

/// Applies `times` the group's impulses, including those of its drives, to the records (scaled velocities).
template <class T>
void apply_joints(const JointGroup<T>& g, const JointDrive<T>* drives, Record8<T>* records, uint32_t end,
                  T times) {
  using W = Wide<T>;
  W a[6], b[6], f[6];
  gather6(records, g.a, a), gather6(records, g.b, b);
  for (int k = 0; k < 6; ++k) f[k] = g.impulse[k];
  for (uint32_t i = 0; i < g.drives; ++i) {
    const W total = detail::total_impulse(drives[i]);
    for (int k = 0; k < 6; ++k) f[k] = madd(total, drives[i].share[k], f[k]);
  }
  for (W& x : f) x *= W(times);
  if (g.flags & JointGroup<T>::kTurns) {
    detail::push_joint<6>(g, f, a, b);
  } else {
    detail::push_joint<3>(g, f, a, b);
  }
  scatter6(records, g.a, end, a), scatter6(records, g.b, end, b);
}

/// Applies the spring forces of the substep's start for a group. All springs act before any locked row
/// responds, because reactions that lag a substep behind their force add energy to oscillations.
template <class T>
void pull_springs(const JointGroup<T>& g, JointDrive<T>* drives, Record8<T>* v, uint32_t end) {
  using W = Wide<T>;
  W a[6], b[6];
  gather6(v, g.a, a), gather6(v, g.b, b);
  for (uint32_t i = 0; i < g.drives; ++i) {
    JointDrive<T>& d = drives[i];
    if (!(d.laws & JointDrive<T>::kSpring)) continue;
    d.moved = g.gap[d.row] - d.start;
    W speed = detail::joint_speed(g, d.row, a, b);
    detail::push_drive(g, d, detail::two_sided<T>(d.spring, W(0), d.moved, d, speed), a, b);
  }
  scatter6(v, g.a, end, a), scatter6(v, g.b, end, b);
}

/// One pass: velocities only, or position errors as well in a bias pass. `drives`: those of the group.
template <ContactSolve kind, class T>
void solve_joints(JointGroup<T>& g, JointDrive<T>* drives, Record8<T>* v, uint32_t end,
                  const JointPass<T>& pass) {
  Wide<T> a[6], b[6];
  gather6(v, g.a, a), gather6(v, g.b, b);
  if (g.flags & JointGroup<T>::kTurns) {
    detail::solve_locked<kind, 6>(g, a, b, pass);
  } else {
    detail::solve_locked<kind, 3>(g, a, b, pass);
  }
  for (uint32_t k = 0; k < g.drives; ++k) detail::solve_drive<kind>(g, drives[k], a, b, pass);
  if (g.flags & JointGroup<T>::kBounded) {
    detail::bound_motors(g, drives, 0, g.bound[0], a, b);
    detail::bound_motors(g, drives, 3, g.bound[1], a, b);
  }
  scatter6(v, g.a, end, a), scatter6(v, g.b, end, b);
}

}  // namespace truestep
