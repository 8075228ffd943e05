#include "engine/systems/rigid2d/solver/solver_joint.h"

#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"

namespace truestep::rigid2d {
namespace {

template <class T>
struct At {
  T v[8];
};

/// The bodies of a joint, its current geometry and the rows that act on them.
template <class T>
struct Acting {
  JointRow<T>& j;
  At<T>&a, &b;
  JointPass pass;
  T h;
  T ax, ay, bx, by;  // current anchors
  T dx, dy;          // from anchor to anchor

  Acting(JointRow<T>& row, At<T>& first, At<T>& second, JointPass p, T step)
      : j(row), a(first), b(second), pass(p), h(step) {
    turn(a.v[6], j.ax, j.ay, ax, ay);
    turn(b.v[6], j.bx, j.by, bx, by);
    dx = j.ex + (b.v[4] - a.v[4]) + (bx - j.bx) - (ax - j.ax);
    dy = j.ey + (b.v[5] - a.v[5]) + (by - j.by) - (ay - j.ay);
  }
  static void turn(T angle, T x, T y, T& tx, T& ty) {
    const trig::SinCos t = trig::sincos(static_cast<double>(angle));
    const T c = static_cast<T>(t.cos), s = static_cast<T>(t.sin);
    tx = c * x - s * y, ty = s * x + c * y;
  }
  T angle() const { return j.angle + (b.v[6] - a.v[6]); }

  void turn_by(T p, T ratio_a, T ratio_b) { a.v[2] += a.v[7] * ratio_a * p, b.v[2] += b.v[7] * ratio_b * p; }
  void push(T px, T py) {
    a.v[0] -= a.v[3] * px, a.v[1] -= a.v[3] * py, a.v[2] -= a.v[7] * (ax * py - ay * px);
    b.v[0] += b.v[3] * px, b.v[1] += b.v[3] * py, b.v[2] += b.v[7] * (bx * py - by * px);
  }
  /// Impulse along u: on a it acts at b's anchor, which keeps sliding joints balanced.
  void push_along(T p, T ux, T uy) {
    const T sa = (ax + dx) * uy - (ay + dy) * ux, sb = bx * uy - by * ux;
    a.v[0] -= a.v[3] * p * ux, a.v[1] -= a.v[3] * p * uy, a.v[2] -= a.v[7] * p * sa;
    b.v[0] += b.v[3] * p * ux, b.v[1] += b.v[3] * p * uy, b.v[2] += b.v[7] * p * sb;
  }

  enum class Law : uint8_t { hold, spring, servo, motor, lower };
  struct Row {
    Law law = Law::hold;
    T C = 0;                 // error, or target speed of a motor
    SoftConstraint<T> soft;  // for hold, lower and servo
    T least = -HUGE_VAL, most = HUGE_VAL;
  };
  /// Springs pull before the constraints respond: a response one substep after the pull would feed
  /// oscillations.
  bool acts(Law law) const {
    return (law == Law::spring) ? pass != JointPass::bias : pass != JointPass::pull;
  }
  /// Change of the impulse `acc` for speed v and mass m (1/k). A lower bound is one-sided.
  T change(T& acc, const Row& r, T v, T m) const {
    T bias = 0, scale = 1, back = 0;
    switch (r.law) {
      case Law::motor:
        bias = -r.C;
        break;
      case Law::spring:
        return pulled(acc, r.C, v, m);
      case Law::servo:
        bias = r.soft.bias_rate * r.C, scale = r.soft.mass_scale, back = r.soft.impulse_scale;
        break;
      case Law::lower:
        if (r.C > 0) {
          bias = r.C / h;
          break;
        }
        [[fallthrough]];
      case Law::hold:
        if (pass == JointPass::bias) {
          bias = r.soft.bias_rate * r.C, scale = r.soft.mass_scale, back = r.soft.impulse_scale;
        }
        break;
    }
    const T least = r.law == Law::lower ? 0 : r.least;
    const T next = std::max(least, std::min(r.most, acc - m * scale * (v + bias) - back * acc));
    const T d = next - acc;
    acc = next;
    return d;
  }
  /// The same for a spring. If it used the positions after the substep, the relaxation would pull
  /// differently from the pull that moved the bodies, and feed oscillations.
  T pulled(T& acc, T C, T v, T m) const {
    if (pass == JointPass::pull) j.spring.error = C;
    const T next = j.spring.scale * (acc - m * v) - j.spring.pull * j.spring.error, d = next - acc;
    acc = next;
    return d;
  }
  void soften(Law law, T k) const {
    if (law != Law::spring || !(k > 0)) return;
    j.spring.k = k;
    soften_spring(j, h, kResolved2);
  }
  /// A row on the angular velocities: ratio_a w_a + ratio_b w_b.
  void angular(T& acc, const Row& r, T ratio_a, T ratio_b) {
    if (!acts(r.law)) return;
    if (pass == JointPass::warm) return turn_by(acc, ratio_a, ratio_b);
    const T k = a.v[7] * ratio_a * ratio_a + b.v[7] * ratio_b * ratio_b;
    if (pass == JointPass::soften) return soften(r.law, k);
    if (!(k > 0)) return;
    turn_by(change(acc, r, ratio_a * a.v[2] + ratio_b * b.v[2], 1 / k), ratio_a, ratio_b);
  }
  /// A row along u; `sign` -1 turns a lower bound into an upper one.
  void along(T& acc, const Row& r, T ux, T uy) {
    if (!acts(r.law)) return;
    if (pass == JointPass::warm) return push_along(acc, ux, uy);
    if (pass == JointPass::kick || pass == JointPass::unkick) {
      return push_along(pass == JointPass::kick ? -j.spring.half * r.C : j.spring.half * r.C, ux, uy);
    }
    const T sa = (ax + dx) * uy - (ay + dy) * ux, sb = bx * uy - by * ux;
    const T k = a.v[3] + b.v[3] + a.v[7] * sa * sa + b.v[7] * sb * sb;
    if (pass == JointPass::soften) return soften(r.law, k);
    if (!(k > 0)) return;
    const T v = ux * (b.v[0] - a.v[0]) + uy * (b.v[1] - a.v[1]) + sb * b.v[2] - sa * a.v[2];
    push_along(change(acc, r, v, 1 / k), ux, uy);
  }
  /// Both components of the distance between the anchors, with an impulse of at most `most`.
  void point(T* acc, Law law, const SoftConstraint<T>& soft, T most) {
    if (pass == JointPass::soften || pass == JointPass::pull) return;
    if (pass == JointPass::warm) return push(acc[0], acc[1]);
    T rate = 0, scale = 1, back = 0;
    if (law == Law::servo || pass == JointPass::bias) {
      rate = soft.bias_rate, scale = soft.mass_scale, back = soft.impulse_scale;
    }
    T vx = b.v[0] - b.v[2] * by - a.v[0] + a.v[2] * ay + rate * dx;
    T vy = b.v[1] + b.v[2] * bx - a.v[1] - a.v[2] * ax + rate * dy;
    if (law == Law::hold && pass == JointPass::bias) {
      // Rotation of the anchors, as in solve_hinges.
      const T bend_a = T(0.5) * h * a.v[2] * a.v[2], bend_b = T(0.5) * h * b.v[2] * b.v[2];
      vx += bend_a * ax - bend_b * bx, vy += bend_a * ay - bend_b * by;
    }
    const T m = a.v[3] + b.v[3];
    const T k11 = m + a.v[7] * ay * ay + b.v[7] * by * by, k22 = m + a.v[7] * ax * ax + b.v[7] * bx * bx;
    const T k12 = -a.v[7] * ax * ay - b.v[7] * bx * by, determinant = k11 * k22 - k12 * k12;
    if (!(determinant > 0)) return;
    T x = acc[0] - scale * (k22 * vx - k12 * vy) / determinant - back * acc[0];
    T y = acc[1] - scale * (k11 * vy - k12 * vx) / determinant - back * acc[1];
    const T size2 = x * x + y * y;
    if (size2 > most * most) {
      const T shrink = most / std::sqrt(size2);
      x *= shrink, y *= shrink;
    }
    const T px = x - acc[0], py = y - acc[1];
    acc[0] = x, acc[1] = y;
    push(px, py);
  }

  /// The velocity of b's anchor in the frame of a, with an impulse of at most `most` there.
  void drive_point(T* acc, T most) {
    if (pass == JointPass::soften || pass == JointPass::pull) return;
    if (pass == JointPass::warm) return push_along(1, acc[0], acc[1]);
    T wx, wy;
    turn(a.v[6], j.wx, j.wy, wx, wy);
    const T cx = ax + dx, cy = ay + dy;
    const T vx = b.v[0] - b.v[2] * by - a.v[0] + a.v[2] * cy - wx;
    const T vy = b.v[1] + b.v[2] * bx - a.v[1] - a.v[2] * cx - wy;
    const T m = a.v[3] + b.v[3];
    const T k11 = m + a.v[7] * cy * cy + b.v[7] * by * by, k22 = m + a.v[7] * cx * cx + b.v[7] * bx * bx;
    const T k12 = -a.v[7] * cx * cy - b.v[7] * bx * by, determinant = k11 * k22 - k12 * k12;
    if (!(determinant > 0)) return;
    T x = acc[0] - (k22 * vx - k12 * vy) / determinant, y = acc[1] - (k11 * vy - k12 * vx) / determinant;
    const T size2 = x * x + y * y;
    if (size2 > most * most) {
      const T shrink = most / std::sqrt(size2);
      x *= shrink, y *= shrink;
    }
    push_along(1, x - acc[0], y - acc[1]);
    acc[0] = x, acc[1] = y;
  }

  /// Both components of the distance between the anchors and the angle at once. One after the other, force
  /// and torque settle in many substeps: loaded suddenly, a beam's torque was too large by a fifth.
  void pose() {
    if (pass == JointPass::soften || pass == JointPass::pull) return;
    if (pass == JointPass::kick || pass == JointPass::unkick) return;
    T* acc = j.impulse;
    if (pass == JointPass::warm) return push(acc[0], acc[1]), turn_by(acc[5], -1, 1);
    const T inertia = a.v[7] + b.v[7];
    // Without rotation there is no torque.
    if (!(inertia > 0)) return point(acc, Law::hold, j.soft, HUGE_VAL);
    T rate = 0, scale = 1, back = 0;
    T vx = b.v[0] - b.v[2] * by - a.v[0] + a.v[2] * ay, vy = b.v[1] + b.v[2] * bx - a.v[1] - a.v[2] * ax;
    if (pass == JointPass::bias) {
      rate = j.soft.bias_rate, scale = j.soft.mass_scale, back = j.soft.impulse_scale;
      // Rotation of the anchors, as in solve_hinges.
      const T bend_a = T(0.5) * h * a.v[2] * a.v[2], bend_b = T(0.5) * h * b.v[2] * b.v[2];
      vx += rate * dx + bend_a * ax - bend_b * bx, vy += rate * dy + bend_a * ay - bend_b * by;
    }
    const T w = b.v[2] - a.v[2] + rate * angle();
    // K with the rotation eliminated:  m + a7 b7 / (a7 + b7) r r^T, r the arms' difference turned by 90
    // degrees; c: rotation per impulse along x and y.
    const T cx = -(a.v[7] * ay + b.v[7] * by), cy = a.v[7] * ax + b.v[7] * bx;
    const T m = a.v[3] + b.v[3], both = a.v[7] * b.v[7] / inertia, rx = ay - by, ry = bx - ax;
    const T k11 = m + both * rx * rx, k22 = m + both * ry * ry, k12 = both * rx * ry;
    const T determinant = m * (m + both * (rx * rx + ry * ry));
    const T qx = vx - cx * w / inertia, qy = vy - cy * w / inertia;
    const T x = (k22 * qx - k12 * qy) / determinant, y = (k11 * qy - k12 * qx) / determinant;
    const T angular = (w - cx * x - cy * y) / inertia;
    const T px = -scale * x - back * acc[0], py = -scale * y - back * acc[1],
            p = -scale * angular - back * acc[5];
    acc[0] += px, acc[1] += py, acc[5] += p;
    push(px, py), turn_by(p, -1, 1);
  }

  T most_of(T force) const { return force * h; }

  /// Spring, motor and limits on the angle of b relative to a.
  void turning_drive() {
    const Joint& d = *j.joint;
    if (d.has_spring) angular(j.impulse[5], {Law::spring, angle() - static_cast<T>(d.rest), {}}, -1, 1);
    turning_motor();
    if (d.has_lower) angular(j.impulse[3], {Law::lower, angle() - static_cast<T>(d.lower), j.soft}, -1, 1);
    if (d.has_upper) angular(j.impulse[4], {Law::lower, static_cast<T>(d.upper) - angle(), j.soft}, 1, -1);
  }
  void turning_motor() {
    const Joint& d = *j.joint;
    if (!d.has_motor) return;
    const T most = j.most * h;
    angular(j.impulse[2], {Law::motor, motor_speed(angle()), {}, -most, most}, -1, 1);
  }
  /// A motor with a target moves at the speed that approaches it at its rate, whatever its load.
  T motor_speed(T at) const {
    const Joint& d = *j.joint;
    return d.has_target ? j.servo.bias_rate * (j.wanted - at) : j.wanted;
  }
  void sliding_limits(T ux, T uy) {
    const Joint& d = *j.joint;
    const T at = dx * ux + dy * uy;
    if (d.has_lower) along(j.impulse[3], {Law::lower, at - static_cast<T>(d.lower), j.soft}, ux, uy);
    if (d.has_upper) along(j.impulse[4], {Law::lower, static_cast<T>(d.upper) - at, j.soft}, -ux, -uy);
  }

  void solve();
  void distance();
  void pulley();
};

template <class T>
void Acting<T>::distance() {
  const Joint& d = *j.joint;
  const T length = std::sqrt(dx * dx + dy * dy);
  const T ux = length > 0 ? dx / length : 1, uy = length > 0 ? dy / length : 0;
  const bool free = d.has_lower || d.has_upper;
  if (d.has_spring) along(j.impulse[5], {Law::spring, length - static_cast<T>(d.length), {}}, ux, uy);
  if (d.has_lower) along(j.impulse[3], {Law::lower, length - static_cast<T>(d.lower), j.soft}, ux, uy);
  if (d.has_upper) along(j.impulse[4], {Law::lower, static_cast<T>(d.upper) - length, j.soft}, -ux, -uy);
  if (!free && !d.has_spring) {
    along(j.impulse[0], {Law::hold, length - static_cast<T>(d.length), j.soft}, ux, uy);
  }
}

/// The rope must not lengthen: u_a . v_a + ratio u_b . v_b <= 0 where it is taut.
template <class T>
void Acting<T>::pulley() {
  const T ratio = static_cast<T>(j.joint->ratio);
  const T lax = j.gax + a.v[4] + (ax - j.ax), lay = j.gay + a.v[5] + (ay - j.ay);
  const T lbx = j.gbx + b.v[4] + (bx - j.bx), lby = j.gby + b.v[5] + (by - j.by);
  const T la = std::sqrt(lax * lax + lay * lay), lb = std::sqrt(lbx * lbx + lby * lby);
  if (!(la > 0) || !(lb > 0)) return;
  const T uax = -lax / la, uay = -lay / la, ubx = -ratio * lbx / lb, uby = -ratio * lby / lb;
  const T sa = ax * uay - ay * uax, sb = bx * uby - by * ubx;
  const auto pull = [&](T p) {
    a.v[0] += a.v[3] * p * uax, a.v[1] += a.v[3] * p * uay, a.v[2] += a.v[7] * p * sa;
    b.v[0] += b.v[3] * p * ubx, b.v[1] += b.v[3] * p * uby, b.v[2] += b.v[7] * p * sb;
  };
  if (pass == JointPass::soften || pass == JointPass::pull) return;
  if (pass == JointPass::warm) return pull(j.impulse[0]);
  const T k = a.v[3] + a.v[7] * sa * sa + ratio * ratio * b.v[3] + b.v[7] * sb * sb;
  const T v = uax * a.v[0] + uay * a.v[1] + sa * a.v[2] + ubx * b.v[0] + uby * b.v[1] + sb * b.v[2];
  const T slack = static_cast<T>(j.joint->length) - la - ratio * lb;
  pull(change(j.impulse[0], {Law::lower, slack, j.soft}, v, 1 / k));
}

template <class T>
void Acting<T>::solve() {
  const Joint& d = *j.joint;
  const T everything = HUGE_VAL;
  T ux, uy;
  turn(a.v[6], j.ux, j.uy, ux, uy);
  switch (d.kind) {
    case JointKind::revolute:
      turning_drive();
      return point(j.impulse, Law::hold, j.soft, everything);
    case JointKind::weld:
      if (!d.has_spring) return pose();
      angular(j.impulse[5], {Law::spring, angle(), j.soft}, -1, 1);
      return point(j.impulse, Law::hold, j.soft, everything);
    case JointKind::prismatic: {
      const T at = dx * ux + dy * uy;
      if (d.has_spring) along(j.impulse[5], {Law::spring, at - static_cast<T>(d.rest), {}}, ux, uy);
      if (d.has_motor) {
        const T most = j.most * h;
        along(j.impulse[2], {Law::motor, motor_speed(at), {}, -most, most}, ux, uy);
      }
      sliding_limits(ux, uy);
      angular(j.impulse[1], {Law::hold, angle(), j.soft}, -1, 1);
      return along(j.impulse[0], {Law::hold, dy * ux - dx * uy, j.soft}, -uy, ux);
    }
    case JointKind::wheel:
      turning_motor();
      if (d.has_spring) {
        along(j.impulse[5], {Law::spring, dx * ux + dy * uy - static_cast<T>(d.rest), {}}, ux, uy);
      }
      sliding_limits(ux, uy);
      return along(j.impulse[0], {Law::hold, dy * ux - dx * uy, j.soft}, -uy, ux);
    case JointKind::distance:
      return distance();
    case JointKind::motor: {
      const T most = most_of(j.most_turn);
      if (d.at_spin) {
        angular(j.impulse[5], {Law::motor, j.spin, {}, -most, most}, -1, 1);
      } else {
        angular(j.impulse[5], {Law::servo, angle(), j.servo, -most, most}, -1, 1);
      }
      if (d.at_velocity) return drive_point(j.impulse, most_of(j.most));
      return point(j.impulse, Law::servo, j.servo, most_of(j.most));
    }
    case JointKind::mouse:
      return point(j.impulse, Law::servo, j.servo, most_of(j.most));
    case JointKind::gear:
      return angular(j.impulse[0], {Law::hold, j.angle + a.v[6] + static_cast<T>(d.ratio) * b.v[6], j.soft},
                     1, static_cast<T>(d.ratio));
    case JointKind::pulley:
      return pulley();
  }
}

}  // namespace

template <class T>
void solve_joint(JointRow<T>& j, T* rows, uint32_t moved, JointPass pass, T h) {
  At<T> a, b;
  T *ra = rows + 8 * static_cast<size_t>(j.a), *rb = rows + 8 * static_cast<size_t>(j.b);
  std::copy(ra, ra + 8, a.v);
  std::copy(rb, rb + 8, b.v);
  Acting<T> acting(j, a, b, pass, h);
  acting.solve();
  if (j.a < moved) std::copy(a.v, a.v + 3, ra);
  if (j.b < moved) std::copy(b.v, b.v + 3, rb);
}

template void solve_joint<float>(JointRow<float>&, float*, uint32_t, JointPass, float);
template void solve_joint<double>(JointRow<double>&, double*, uint32_t, JointPass, double);

}  // namespace truestep::rigid2d
