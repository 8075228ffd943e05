// Impacts of rigid bodies: contacts that close within a substep faster than a threshold bounce pair by pair,
// one after the other, until none approaches. For one manifold with relative velocities u = J v, u < 0:
//   l >= 0 solves J (v + P) = 0 as well as a few passes can, P = M^-1 J^T l;   s = -(v . P) / (P . P);
//   v' = v + (1 + e) s P
// s makes J (v + s P) . l = 0 hold exactly, so that the kinetic energy changes by
//   -(1 - e^2) (v . P)^2 / (2 P . P)
// whatever residual the passes leave: it never grows, and is conserved for e = 1 (Poisson's hypothesis; Smith
// et al. 2012, "Reflections on simultaneous impact"). Friction follows Coulomb's law with the impulse of the
// impact itself. A body that hits after the time tau moves at its old velocity until then, for which
// `toi_correction` receives tau (v - v'); the approach velocity includes the forces up to that time only. A
// body that hits again does so from where it is then, and not before: a light body between a heavy one and
// the floor hits each of them many times within a substep, and with times that went back and forth it left
// the gap between them (by half a metre).
#pragma once
#include <algorithm>

#include "engine/kernels/rigid/contact_solve3.h"
#include "engine/kernels/rigid/impact_limits.h"

namespace truestep {

template <class T>
struct ImpactPass {
  T h;          ///< s, of the substep
  T threshold;  ///< m/s; slower approaches do not bounce
};

/// Records of all bodies.
template <class T>
struct ImpactRecords {
  Record8<T>* velocity;
  const Record8<T>* change;    ///< of the velocity due to forces in a substep; already in `velocity`
  Record8<T>* toi_correction;  ///< to be added to the displacements
  T* last;                     ///< s since the start of the substep, of the last impact
};

/// The contacts of a group that take part in an impact.
enum class Hits : uint8_t { bouncing, all };

/// Applies the impacts that are due in a group; false if there are none.
template <Hits kHits, class T>
bool hit_contacts(ContactGroup<T>& g, const ImpactRecords<T>& bodies, uint32_t end,
                  const ImpactPass<T>& pass) {
  using W = Wide<T>;
  namespace r = contact_rows;
  constexpr int kPasses = 8;
  const W zero(0), one(1);
  W a[6], b[6], v[6], wa[6], wb[6], shift[6], speed[4], closes[4], due(0), wait(T(1e30));
  gather6(bodies.velocity, g.a, a), gather6(bodies.velocity, g.b, b);
  detail::relative_motion(g, a, b, v);
  // Bodies that have already hit move along new lines, which would have begun elsewhere.
  gather6(bodies.toi_correction, g.a, wa), gather6(bodies.toi_correction, g.b, wb);
  detail::relative_motion(g, wa, wb, shift);
  // A contact that ends the substep within rounding of closing counts as closed: the next substep would find
  // it already stopped.
  W rounding(0);
  for (int k = 0; k < 3; ++k) {
    const W va = g.root_a * a[k], vb = g.root_b * b[k];
    rounding += max(va, -va) + max(vb, -vb);
  }
  rounding *= W(impact_rounding<T> * pass.h);
  for (int p = 0; p < g.points; ++p) {
    const auto& at = g.place[p];
    speed[p] = nmadd(at.x, v[5], madd(at.y, v[4], v[0])) + at.drift;
    const W gap = at.separation + nmadd(at.x, shift[5], madd(at.y, shift[4], shift[0]));
    const W reached = rounding - madd(speed[p], W(pass.h), gap);
    // The inverse is zero in lanes without a point.
    closes[p] = where_positive(g.point_inverse[p],
                               where_positive(reached, where_positive(-speed[p], one, zero), zero), zero);
    due = where_positive(-speed[p] - W(pass.threshold), max(due, closes[p]), due);
    const W reaches = max(gap, zero) / where_positive(-speed[p], -speed[p], one);
    wait = where_positive(closes[p], min(wait, reaches), wait);
  }
  if constexpr (kHits == Hits::bouncing) due = where_positive(g.restitution, due, zero);
  if (!any_below(zero, due)) return false;
  for (int lane = 0; lane < W::kLanes; ++lane) {
    const T before = std::max(bodies.last[g.a[lane]], bodies.last[g.b[lane]]);
    if (before > wait[lane]) wait.set(lane, before);
  }
  {
    W fa[6], fb[6];
    gather6(bodies.change, g.a, fa), gather6(bodies.change, g.b, fb);
    const W still = max(one - wait * W(1 / pass.h), zero);
    // Forces only: gyroscopic torques would have to follow the new angular velocity to conserve energy.
    const W pulls = g.root_b * r::dot(g.normal, fb) - g.root_a * r::dot(g.normal, fa);
    for (int p = 0; p < g.points; ++p) speed[p] = nmadd(still, pulls, speed[p]);
  }

  // Compression, in the normal velocity and the angular velocities about the tangents.
  const auto K = [&](int p, int q) -> const W& { return g.k[detail::at(p, q)]; };
  W l[4] = {}, f[6] = {}, moved[3] = {};
  for (int e = 0; e < (g.points > 1 ? kPasses : 1); ++e) {
    for (int p = 0; p < g.points; ++p) {
      const auto& at = g.place[p];
      const W u = speed[p] + nmadd(at.x, moved[2], madd(at.y, moved[1], moved[0]));
      const W total = max(nmadd(g.point_inverse[p], u, l[p]), zero) * closes[p], added = total - l[p];
      const W about = at.y * added, around = -(at.x * added);
      l[p] = total;
      f[0] += added, f[4] += about, f[5] += around;
      const int rows[3] = {0, 4, 5};
      for (int k = 0; k < 3; ++k) {
        moved[k] += madd(K(rows[k], 5), around, madd(K(rows[k], 4), about, K(rows[k], 0) * added));
      }
    }
  }
  W work(0), torque(0);
  for (int p = 0; p < g.points; ++p) {
    work = madd(l[p], speed[p], work);
    torque = madd(g.lever[p], l[p], torque);
  }
  const W square = madd(f[5], moved[2], madd(f[4], moved[1], f[0] * moved[0]));
  const W scale = due * max(-work, zero) * (one + g.restitution) / where_positive(square, square, one);
  if (!any_below(zero, scale)) return false;
  // Where the impulse acts: x and y from the centre.
  const W pressed = where_positive(f[0], f[0], one), x = -f[5] / pressed, y = f[4] / pressed;
  torque *= scale;
  for (const int k : {0, 4, 5}) {
    f[k] *= scale;
    for (int p = 0; p < 6; ++p) v[p] = madd(K(p, k), f[k], v[p]);
  }
  const W twist = max(min(-(g.twist_inverse * (v[3] + g.twist_drift)), torque), -torque);
  detail::add_impulse(g, 3, twist, v, f);
  // Friction at that place: its velocity is that of c plus the contribution of the rotation about n.
  const W turn = v[3] + g.twist_drift;
  const W slip[2] = {nmadd(y, turn, v[1] + g.slide_drift[0]), madd(x, turn, v[2] + g.slide_drift[1])};
  W inverse[3];
  r::invert(K(1, 1) + y * (y * K(3, 3) - K(3, 1) - K(3, 1)),
            K(2, 1) + x * K(3, 1) - y * K(3, 2) - x * y * K(3, 3),
            K(2, 2) + x * (x * K(3, 3) + K(3, 2) + K(3, 2)), inverse);
  W slide[2] = {zero, zero}, added[2];
  const W wanted[2] = {-madd(inverse[1], slip[1], inverse[0] * slip[0]),
                       -madd(inverse[2], slip[1], inverse[1] * slip[0])};
  r::clip(slide, wanted, g.friction * f[0], added);
  f[1] += added[0], f[2] += added[1], f[3] += nmadd(y, added[0], x * added[1]);

  W da[6] = {}, db[6] = {};
  detail::push_apart(g, f, da, db);
  for (int e = 0; e < 6; ++e) {
    a[e] += da[e], b[e] += db[e];
    wa[e] = nmadd(wait, da[e], wa[e]), wb[e] = nmadd(wait, db[e], wb[e]);
  }
  scatter6(bodies.velocity, g.a, end, a), scatter6(bodies.velocity, g.b, end, b);
  scatter6(bodies.toi_correction, g.a, end, wa), scatter6(bodies.toi_correction, g.b, end, wb);
  for (int lane = 0; lane < W::kLanes; ++lane) {
    if (!(scale[lane] > 0)) continue;
    for (const uint32_t body : {g.a[lane], g.b[lane]}) {
      if (body < end) bodies.last[body] = wait[lane];
    }
  }
  return true;
}

}  // namespace truestep
