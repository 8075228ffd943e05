// Impacts in the plane, as in space (engine/kernels/rigid/impact_rows3.h): contacts that close within a small
// step faster than a threshold bounce as pairs, one after the other, until none approaches. For the two
// points of a contact with normal speeds u:  l >= 0, K l + u >= 0, complementary, solved exactly; then
//   impulse = (1 + e) s l,   s = -(l . u) / (l . K l),
// which changes the kinetic energy by -(1 - e^2) (l . u)^2 / (2 l . K l), never up. As in space, a body that
// hits again within a substep does so from where it is then, and not before its last hit.
#pragma once
#include "engine/kernels/rigid/impact_limits.h"
#include "engine/systems/rigid2d/solver/solver_contact.h"

namespace truestep::rigid2d {

/// Rows of eight per body, as in the solver.
template <class T>
struct ImpactRows {
  T* rows;
  const T* push;  ///< vx vy added by forces in the substep, already in `rows`
  /// Shift and angle, added to those of the bodies; s since its start, of the last impact.
  T* toi_correction;
  uint32_t moved;
};

/// Contacts of a pack on which an impact may act.
enum class Hits : uint8_t { bouncing, all };

/// Applies bounces to the due contacts of a pack; false when there are none.
template <Hits kHits, class T>
bool hit(const ContactPack<T>& c, const ImpactRows<T>& bodies, T h, T threshold) {
  using W = Wide<T>;
  const W zero = W::zero(), one = W::all(1);
  Ends<T> e(bodies.rows, c.a, c.b);
  W u[2], closes[2], separation[2], vx, vy, due = zero, wait = W::all(T(1e30));
  separations(c, e, separation);
  // Bodies that have already hit move along new lines, which would have begun elsewhere.
  Ends<T> correction(bodies.toi_correction, c.a, c.b);
  // A substep that ends within rounding of a hit includes the hit: in the next one it would already have
  // been stopped.
  W rounding = zero;
  for (int k = 0; k < 2; ++k) rounding += max(e.a[k], -e.a[k]) + max(e.b[k], -e.b[k]);
  rounding *= W::all(impact_rounding<T> * h);
  for (int i = 0; i < 2; ++i) {
    const auto& p = c.point[i];
    correction.relative(p.ax, p.ay, p.bx, p.by, vx, vy);
    separation[i] += madd(vx, c.nx, vy * c.ny);
    e.relative(p.ax, p.ay, p.bx, p.by, vx, vy);
    u[i] = madd(vx, c.nx, vy * c.ny);
    const W reached = rounding - madd(u[i], W::all(h), separation[i]);
    closes[i] =
        select(p.normal_mass > zero, select(reached > zero, select(u[i] < zero, one, zero), zero), zero);
    due = select(u[i] < W::all(-threshold), max(due, closes[i]), due);
    wait =
        select(closes[i] > zero, min(wait, max(separation[i], zero) / select(u[i] < zero, -u[i], one)), wait);
  }
  if constexpr (kHits == Hits::bouncing) due = select(c.restitution > zero, due, zero);
  if (!any_below(zero, due)) return false;
  wait = max(wait, max(correction.a[3], correction.b[3]));
  {
    W fa[8], fb[8];
    gather_rows8(bodies.push, c.a, fa), gather_rows8(bodies.push, c.b, fb);
    const W pull = madd(fb[0] - fa[0], c.nx, (fb[1] - fa[1]) * c.ny) * max(one - wait * W::all(1 / h), zero);
    u[0] -= pull, u[1] -= pull;
  }
  // Both points at once, without separating ones.
  const W g0 = c.point[0].normal_mass * closes[0], g1 = c.point[1].normal_mass * closes[1], k01 = c.coupling;
  const W inverse = one / max(nmadd(k01 * g0, k01 * g1, one), W::all(T(0.01)));
  const W both0 = g0 * inverse * nmadd(one, u[0], k01 * g1 * u[1]);
  const W both1 = g1 * inverse * nmadd(one, u[1], k01 * g0 * u[0]);
  const W only0 = max(-(g0 * u[0]), zero), only1 = max(-(g1 * u[1]), zero);
  const auto both = min(both0, both1) < zero;
  const auto second = madd(k01, only0, u[1]) * closes[1] < zero;
  W l0 = select(both, select(second, zero, only0), both0),
    l1 = select(both, select(second, only1, zero), both1);
  const W work = madd(l0, u[0], l1 * u[1]);
  const W square = madd(c.stiffness0 * l0, l0, madd(c.stiffness1 * l1, l1, W::all(2) * k01 * l0 * l1));
  const W scale = due * max(-work, zero) * (one + c.restitution) / select(square > zero, square, one);
  if (!any_below(zero, scale)) return false;
  l0 *= scale, l1 *= scale;

  const Ends<T> before = e;
  const auto& [p, q] = c.point;
  e.push(l0 * c.nx, l0 * c.ny, p.ax, p.ay, p.bx, p.by);
  e.push(l1 * c.nx, l1 * c.ny, q.ax, q.ay, q.bx, q.by);
  // Friction where the impact acts.
  const W load = l0 + l1, share = l0 / select(load > zero, load, one), rest = one - share;
  const W ax = madd(share, p.ax, rest * q.ax), ay = madd(share, p.ay, rest * q.ay);
  const W bx = madd(share, p.bx, rest * q.bx), by = madd(share, p.by, rest * q.by);
  const W ta = madd(ax, c.nx, ay * c.ny), tb = madd(bx, c.nx, by * c.ny);
  const W k = madd(e.a[7] * ta, ta, madd(e.b[7] * tb, tb, e.a[3] + e.b[3]));
  e.relative(ax, ay, bx, by, vx, vy);
  const W slip = nmadd(vx, c.ny, vy * c.nx) - c.surface_speed, most = c.friction * load;
  const W drag = max(-most, min(most, -(slip / select(k > zero, k, one))));
  e.push(-(drag * c.ny), drag * c.nx, ax, ay, bx, by);
  e.store(bodies.rows, bodies.moved);

  for (int i = 0; i < 3; ++i) {
    correction.a[i] = nmadd(wait, e.a[i] - before.a[i], correction.a[i]);
    correction.b[i] = nmadd(wait, e.b[i] - before.b[i], correction.b[i]);
  }
  correction.a[3] = select(scale > zero, wait, correction.a[3]);
  correction.b[3] = select(scale > zero, wait, correction.b[3]);
  correction.store(bodies.toi_correction, bodies.moved);
  return true;
}

}  // namespace truestep::rigid2d
