// Kernels over packs of contacts and hinges. `rows` are the bodies' rows of eight; rows from `moved` on take
// no impulses.
#pragma once
#include <type_traits>

#include "engine/systems/rigid2d/solver/solver.h"

namespace truestep::rigid2d {

enum class Pass : uint8_t { bias, relax };

template <class T>
struct Ends {
  Wide<T> a[8], b[8];
  const uint32_t *ia, *ib;

  Ends(const T* rows, const uint32_t* i, const uint32_t* j) : ia(i), ib(j) {
    gather_rows8(rows, i, a);
    gather_rows8(rows, j, b);
  }
  void store(T* rows, uint32_t moved) const {
    scatter_rows4(rows, ia, moved, a);
    scatter_rows4(rows, ib, moved, b);
  }
  /// Impulse (px, py) on b at (bx, by), its opposite on a at (ax, ay).
  void push(Wide<T> px, Wide<T> py, Wide<T> ax, Wide<T> ay, Wide<T> bx, Wide<T> by) {
    a[0] = nmadd(a[3], px, a[0]), a[1] = nmadd(a[3], py, a[1]);
    a[2] = nmadd(a[7], nmadd(ay, px, ax * py), a[2]);
    b[0] = madd(b[3], px, b[0]), b[1] = madd(b[3], py, b[1]);
    b[2] = madd(b[7], nmadd(by, px, bx * py), b[2]);
  }
  /// Velocity of b at its anchor minus that of a at its anchor.
  void relative(Wide<T> ax, Wide<T> ay, Wide<T> bx, Wide<T> by, Wide<T>& vx, Wide<T>& vy) const {
    vx = nmadd(b[2], by, b[0]) - nmadd(a[2], ay, a[0]);
    vy = madd(b[2], bx, b[1]) - madd(a[2], ax, a[1]);
  }
};

/// Effective masses of a pack from the masses in its bodies' rows; `there`: 1 where a lane has this point.
template <class T>
void weigh(ContactPack<T>& c, const Ends<T>& e, const Wide<T> there[2]) {
  using W = Wide<T>;
  const W zero = W::zero(), one = W::all(1), m = e.a[3] + e.b[3];
  W arm_a[2], arm_b[2], k[2];
  for (int i = 0; i < 2; ++i) {
    auto& p = c.point[i];
    arm_a[i] = nmadd(p.ay, c.nx, p.ax * c.ny), arm_b[i] = nmadd(p.by, c.nx, p.bx * c.ny);
    const W ta = madd(p.ax, c.nx, p.ay * c.ny), tb = madd(p.bx, c.nx, p.by * c.ny);
    k[i] = madd(e.a[7] * arm_a[i], arm_a[i], madd(e.b[7] * arm_b[i], arm_b[i], m));
    const W kt = madd(e.a[7] * ta, ta, madd(e.b[7] * tb, tb, m));
    p.normal_mass = select(there[i] > zero, one / k[i], zero);
    p.tangent_mass = select(there[i] > zero, one / kt, zero);
  }
  c.stiffness0 = k[0] * there[0], c.stiffness1 = k[1] * there[1];
  c.coupling = there[1] * madd(e.a[7] * arm_a[0], arm_a[1], madd(e.b[7] * arm_b[0], arm_b[1], m));
  // Fully coupled points (bodies that do not rotate) make K singular: with a slightly smaller coupling they
  // share the load.
  const W all = c.stiffness0 * c.stiffness1;
  c.held = select(c.coupling * c.coupling > W::all(T(0.99)) * all, W::all(T(0.995)) * sqrt(all), c.coupling);
  if (c.rolls) {
    const W turning = e.a[7] + e.b[7];
    c.rolling_mass = select(turning > zero, one / turning, zero);
  }
}

/// cos - 1 and sin of a small angle to seventh order.
template <class T>
inline void small_turn(Wide<T> t, Wide<T>& c1, Wide<T>& s) {
  using W = Wide<T>;
  const W u = t * t;
  c1 = u * madd(u, madd(u, W::all(T(-1.0 / 720)), W::all(T(1.0 / 24))), W::all(T(-0.5)));
  s = t * madd(u, madd(u, W::all(T(1.0 / 120)), W::all(T(-1.0 / 6))), W::all(T(1)));
}

template <class T>
void warm_start(const ContactPack<T>& c, T* rows, uint32_t moved) {
  using W = Wide<T>;
  Ends<T> e(rows, c.a, c.b);
  for (const auto& p : c.point) {
    const W px = nmadd(p.tangent, c.ny, p.normal * c.nx), py = madd(p.tangent, c.nx, p.normal * c.ny);
    e.push(px, py, p.ax, p.ay, p.bx, p.by);
  }
  if (c.rolls) {
    e.a[2] = nmadd(e.a[7], c.rolling_impulse, e.a[2]);
    e.b[2] = madd(e.b[7], c.rolling_impulse, e.b[2]);
  }
  e.store(rows, moved);
}

/// Separation (m) of the two points. The centre of the rounding (corner or centre of a shape) turns with the
/// body; the rounded surface point stays in place along the normal from there.
template <class T>
void separations(const ContactPack<T>& c, const Ends<T>& e, Wide<T> out[2]) {
  using W = Wide<T>;
  W ca, sa, cb, sb;
  small_turn(e.a[6], ca, sa);
  small_turn(e.b[6], cb, sb);
  const W rounding = madd(ca, c.round_a, cb * c.round_b);
  const W shift = madd(e.b[4] - e.a[4], c.nx, madd(e.b[5] - e.a[5], c.ny, rounding));
  for (int i = 0; i < 2; ++i) {
    const auto& p = c.point[i];
    const W tx = nmadd(sb, p.by, cb * p.bx) - nmadd(sa, p.ay, ca * p.ax);
    const W ty = madd(sb, p.bx, cb * p.by) - madd(sa, p.ax, ca * p.ay);
    out[i] = p.separation + madd(tx, c.nx, madd(ty, c.ny, shift));
  }
}

/// Fraction of push_out_speed up to which the speed of pushes is left to the relaxation, which removes most
/// of it: walls and towers lean where positions are corrected separately from velocities.
inline constexpr double kGentlePush = 1.0 / 32;

/// Fraction of a depth that a substep recovers, at least, where its push is taken back: 12/s with the
/// defaults, as in space. The softness of a body with many contacts, which keeps heaps at rest, leaves a
/// quarter of that, and bodies that had fallen into a heap stayed in it for seconds.
inline constexpr double kPartingShare = 0.05;

/// Negative in lanes that overlap so deeply that a push would be faster than this, and not because of their
/// load: penetration caused by a load is sustained by an equally fast push.
template <class T>
Wide<T> depth_left(const ContactPack<T>& c, const Wide<T> separation[2], T push_out_speed) {
  using W = Wide<T>;
  const W gentle = W::all(T(kGentlePush) * push_out_speed);
  const auto left = [&](int i) { return c.point[i].normal_mass * madd(c.bias_rate, separation[i], gentle); };
  const W load = c.point[0].normal + c.point[1].normal;
  return madd(W::all(2) * c.impulse_scale, load, c.mass_scale * min(left(0), left(1)));
}

template <class T>
void remember_impulses(ContactPack<T>& c) {
  for (int i = 0; i < 2; ++i) {
    c.before.normal[i] = c.point[i].normal, c.before.tangent[i] = c.point[i].tangent;
  }
  c.before.rolling = c.rolling_impulse;
}

/// Removes from the rows the velocity that a push has added since, in lanes where `taken` is 1: the bodies
/// have moved by the push and keep none of its speed.
template <class T>
void take_push_back(ContactPack<T>& c, T* rows, uint32_t moved) {
  using W = Wide<T>;
  Ends<T> e(rows, c.a, c.b);
  const auto back = [&](W& now, const W& before) {
    const W change = c.before.taken * (before - now);
    now += change;
    return change;
  };
  for (int i = 0; i < 2; ++i) {
    auto& p = c.point[i];
    const W n = back(p.normal, c.before.normal[i]), t = back(p.tangent, c.before.tangent[i]);
    e.push(nmadd(t, c.ny, n * c.nx), madd(t, c.nx, n * c.ny), p.ax, p.ay, p.bx, p.by);
  }
  if (c.rolls) {
    const W d = back(c.rolling_impulse, c.before.rolling);
    e.a[2] = nmadd(e.a[7], d, e.a[2]), e.b[2] = madd(e.b[7], d, e.b[2]);
  }
  e.store(rows, moved);
}

/// Remaining push speed of a pair (m/s): bodies that overlap many others must not add up all their pushes.
template <class T>
Wide<T> push_left(const ContactPack<T>& c, const Ends<T>& e, const T* start, T push_out_speed) {
  using W = Wide<T>;
  const Ends<T> before(start, c.a, c.b);
  const auto gained = [](const W now[8], const W then[8]) {
    const W x = now[0] - then[0], y = now[1] - then[1], w = now[2] - then[2];
    // Rotation counts by the radius of gyration.
    const W inertia = select(now[7] > W::zero(), W::all(1) / now[7], W::zero());
    return sqrt(madd(w * w, now[3] * inertia, madd(x, x, y * y)));
  };
  const W all = gained(e.a, before.a) + gained(e.b, before.b);
  return max(nmadd(W::all(T(1.2)), all, W::all(push_out_speed)), W::zero());
}

/// Surfaces of a pack: still, or turning. `begun` and `now`: s from the start of the step to that of the
/// pass's separations, and to the moment whose velocities it solves.
struct StillSurfaces {};
template <class T>
struct TurningSurfaces {
  const CarriedPack<T>& carried;
  T begun, now;
};

/// `start`: rows before the pushes of this substep where some overlap deeply, else null. Returns true (in
/// a relaxation) where a contact is deep.
template <Pass kPass, class T, class Surfaces = StillSurfaces>
bool solve_contacts(ContactPack<T>& c, T* rows, uint32_t moved, T inverse_h, T push_out_speed, const T* start,
                    const Surfaces& surfaces = {}) {
  using W = Wide<T>;
  constexpr bool kTurns = !std::is_same_v<Surfaces, StillSurfaces>;
  const W zero = W::zero(), one = W::all(1);
  W surface = c.surface_speed;
  if constexpr (kTurns) {
    surface -= madd(surfaces.carried.along_rate, W::all(surfaces.now), surfaces.carried.along);
  }
  Ends<T> e(rows, c.a, c.b);
  W vx, vy, most_push = W::all(push_out_speed);
  W rate = c.bias_rate;
  if (kPass == Pass::bias && start) {
    most_push = push_left(c, e, start, push_out_speed);
    rate = select(c.before.taken > zero, max(rate, W::all(T(kPartingShare) * inverse_h)), rate);
  }

  // Friction first, so that normals are solved last. The tangent is the normal turned left.
  const auto rub = [&] {
    for (auto& p : c.point) {
      e.relative(p.ax, p.ay, p.bx, p.by, vx, vy);
      const W slip = nmadd(vx, c.ny, vy * c.nx) - surface;
      const W most = c.friction * p.normal;
      const W next = max(-most, min(most, nmadd(p.tangent_mass, slip, p.tangent)));
      const W d = next - p.tangent;
      p.tangent = next;
      e.push(-(d * c.ny), d * c.nx, p.ax, p.ay, p.bx, p.by);
    }
  };
  const W load = c.point[0].normal + c.point[1].normal;
  rub();
  if (c.rolls) {
    const W most = c.rolling * load, spin = e.b[2] - e.a[2];
    const W next = max(-most, min(most, nmadd(c.rolling_mass, spin, c.rolling_impulse)));
    const W d = next - c.rolling_impulse;
    c.rolling_impulse = next;
    e.a[2] = nmadd(e.a[7], d, e.a[2]), e.b[2] = madd(e.b[7], d, e.b[2]);
  }

  // Both normals at once:  x >= 0,  K x + q >= 0,  complementary, with K softened on its diagonal. Solved one
  // after the other they would tilt a stack, and need more steps to agree.
  W q[2], g[2], separation[2];
  separations(c, e, separation);
  if constexpr (kTurns) {
    for (W& s : separation) s = madd(surfaces.carried.missed, W::all(surfaces.begun), s);
  }
  for (int i = 0; i < 2; ++i) {
    const auto& p = c.point[i];
    const W& s = separation[i];
    const auto apart = s > zero;
    W bias = s * W::all(inverse_h);
    g[i] = p.normal_mass;
    if constexpr (kPass == Pass::bias) {
      bias = select(apart, bias, max(rate * s, -most_push));
      g[i] = select(apart, g[i], g[i] * c.mass_scale);
    } else {
      bias = select(apart, bias, zero);
    }
    e.relative(p.ax, p.ay, p.bx, p.by, vx, vy);
    q[i] = madd(vx, c.nx, madd(vy, c.ny, bias));
    if constexpr (kTurns) {
      q[i] += madd(surfaces.carried.lift_rate, W::all(surfaces.now), surfaces.carried.lift);
    }
    if constexpr (kPass == Pass::relax) {
      // A contact that will bounce is not slowed down before the impact.
      if (c.bounces) {
        const W waits = select(apart, select(p.normal > zero, zero, c.restitution), zero);
        q[i] = select(waits > zero, W::all(T(1e6)), q[i]);
      }
    }
  }
  {
    const W n0 = c.point[0].normal, n1 = c.point[1].normal;
    q[0] = nmadd(c.stiffness0, n0, nmadd(c.held, n1, q[0]));
    q[1] = nmadd(c.stiffness1, n1, nmadd(c.held, n0, q[1]));
  }
  const W k01 = c.held;
  const W inverse = one / max(nmadd(k01 * g[0], k01 * g[1], one), W::all(T(0.01)));
  const W both0 = g[0] * inverse * nmadd(one, q[0], k01 * g[1] * q[1]);
  const W both1 = g[1] * inverse * nmadd(one, q[1], k01 * g[0] * q[0]);
  const W only0 = max(-(g[0] * q[0]), zero), only1 = max(-(g[1] * q[1]), zero);
  const auto both = min(both0, both1) < zero;
  const auto second = madd(k01, only0, q[1]) < zero;
  const W x[2] = {select(both, select(second, zero, only0), both0),
                  select(both, select(second, only1, zero), both1)};
  for (int i = 0; i < 2; ++i) {
    auto& p = c.point[i];
    const W d = x[i] - p.normal;
    p.normal = x[i];
    e.push(d * c.nx, d * c.ny, p.ax, p.ay, p.bx, p.by);
  }
  // What goes round is pulled anew in every substep: what the normals leave of its slip adds up, and nothing
  // brings it back, while separations correct what friction leaves of theirs.
  if constexpr (kTurns) {
    if (!start) rub();
  }
  e.store(rows, moved);
  return kPass == Pass::relax && any_below(depth_left(c, separation, push_out_speed), zero);
}

template <class T>
void turn_anchors(const HingePack<T>& c, const Ends<T>& e, Wide<T>& ax, Wide<T>& ay, Wide<T>& bx,
                  Wide<T>& by) {
  using W = Wide<T>;
  W ca, sa, cb, sb;
  small_turn(e.a[6], ca, sa);
  small_turn(e.b[6], cb, sb);
  ax = c.ax + nmadd(sa, c.ay, ca * c.ax), ay = c.ay + madd(sa, c.ax, ca * c.ay);
  bx = c.bx + nmadd(sb, c.by, cb * c.bx), by = c.by + madd(sb, c.bx, cb * c.by);
}

template <class T>
void warm_start(const HingePack<T>& c, T* rows, uint32_t moved) {
  Ends<T> e(rows, c.a, c.b);
  Wide<T> ax, ay, bx, by;
  turn_anchors(c, e, ax, ay, bx, by);
  e.push(c.ix, c.iy, ax, ay, bx, by);
  e.store(rows, moved);
}

/// Both components at once:  K impulse = -(v + bias_rate C). The bias pass accounts for the rotation of
/// anchors about the centres of their bodies, which leave the straight path by w^2 h^2 r / 2 in a substep
/// h: with this a swing keeps its energy.
template <Pass kPass, class T>
void solve_hinges(HingePack<T>& c, T* rows, uint32_t moved, const SoftConstraint<T>& soft, T h) {
  using W = Wide<T>;
  Ends<T> e(rows, c.a, c.b);
  W ax, ay, bx, by, vx, vy;
  turn_anchors(c, e, ax, ay, bx, by);
  e.relative(ax, ay, bx, by, vx, vy);
  if constexpr (kPass == Pass::bias) {
    const W rate = W::all(soft.bias_rate);
    vx = madd(rate, c.ex + (e.b[4] - e.a[4]) + ((bx - c.bx) - (ax - c.ax)), vx);
    vy = madd(rate, c.ey + (e.b[5] - e.a[5]) + ((by - c.by) - (ay - c.ay)), vy);
    const W bend_a = W::all(T(0.5) * h) * e.a[2] * e.a[2], bend_b = W::all(T(0.5) * h) * e.b[2] * e.b[2];
    vx = madd(bend_a, ax, nmadd(bend_b, bx, vx)), vy = madd(bend_a, ay, nmadd(bend_b, by, vy));
  }
  const W m = e.a[3] + e.b[3];
  const W k11 = madd(e.a[7] * ay, ay, madd(e.b[7] * by, by, m));
  const W k22 = madd(e.a[7] * ax, ax, madd(e.b[7] * bx, bx, m));
  const W k12 = -madd(e.a[7] * ax, ay, e.b[7] * bx * by);
  const W determinant = nmadd(k12, k12, k11 * k22);
  // Lanes without a joint have no mass on either side.
  const W inverse = select(determinant > W::zero(), W::all(1) / determinant, W::zero());
  W dx = inverse * nmadd(k12, vy, k22 * vx), dy = inverse * nmadd(k12, vx, k11 * vy);
  if constexpr (kPass == Pass::bias) {
    const W scale = W::all(soft.mass_scale), back = W::all(soft.impulse_scale);
    dx = madd(scale, dx, back * c.ix), dy = madd(scale, dy, back * c.iy);
  }
  dx = -dx, dy = -dy;
  c.ix += dx, c.iy += dy;
  e.push(dx, dy, ax, ay, bx, by);
  e.store(rows, moved);
}

}  // namespace truestep::rigid2d
