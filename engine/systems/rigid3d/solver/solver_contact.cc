// Groups of contacts in the solver: how they are filled from manifolds, and which results go back to them.
#include <algorithm>
#include <cmath>

#include "engine/systems/rigid3d/solver/solver.h"
#include "engine/systems/rigid3d/solver/solver_carried.h"
#include "engine/systems/rigid3d/turned_surface.h"

namespace truestep::rigid3d {

namespace {

template <class T>
Vec3 get3(const Wide<T> in[3], int lane) {
  return {in[0][lane], in[1][lane], in[2][lane]};
}

/// The pose at x for which a contact was found `ahead` (s).
Transform turned(const BodyKind& kind, const Rotation& now, const Vec3& spin, double ahead, const Vec3& x) {
  if (!(ahead > 0)) return {now, x};
  return place_after({now, x}, {{}, seen_spin(kind, now, spin)}, ahead);
}

/// Where the load of the last step acts, or the middle of the points.
Vec3 pressed_center(const Contact& c) {
  Vec3 sum;
  double weight = 0;
  for (int p = 0; p < c.manifold.count; ++p) {
    const double w = c.impulse[p] + 1e-12;
    sum += c.manifold.points[p].position * w, weight += w;
  }
  return sum / weight;
}

}  // namespace

template <class T>
void ContactSolver<T>::fill(size_t group, std::span<Contact* const> contacts, const State& s,
                            std::span<const BodyKind> kinds, std::span<const BodyNow> now, double h) {
  const auto kind = s.span<uint32_t>(columns::kind);
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data(),
               *rested = s.f64(columns::sleep_timer).data();
  const auto end = static_cast<uint32_t>(body_.size());
  ContactGroup<T>& g = groups_[group];
  ContactLanes<T> in{};
  g.points = 0, g.flags = 0;
  for (int lane = 0; lane < W::kLanes; ++lane) {
    const uint32_t k = contact_lanes_.member[group * W::kLanes + lane];
    g.a[lane] = g.b[lane] = end;
    if (k == kNoBody) continue;
    const Contact& c = *contacts[k];
    const BodyKind &ka = kinds[kind[c.a]], &kb = kinds[kind[c.b]];
    const Vec3 xa = now[c.a].at.position, xb = now[c.b].at.position + c.apart;
    set3(in.normal, lane, c.manifold.normal);
    set3(in.offset, lane, xb - xa);
    if (c.manifold.count > g.points) g.points = c.manifold.count;
    for (int p = 0; p < c.manifold.count; ++p) {
      set3(in.arm[p], lane, c.manifold.points[p].position - xa);
      in.active[p].set(lane, 1);
      in.separation[p].set(lane, T(c.manifold.points[p].separation - c.penetration_offset - c.uneven[p]));
      in.impulse[p].set(lane, T(c.impulse[p]));
    }
    const Vec3 turn_a = load3(w, c.a), turn_b = load3(w, c.b), &n = c.manifold.normal;
    in.turn.set(lane, T(dot(n, turn_b - turn_a)));
    if (ka.turned_round || kb.turned_round) {
      const Transform at_a = turned(ka, now[c.a].at.rotation, turn_a, c.ahead, xa),
                      at_b = turned(kb, now[c.b].at.rotation, turn_b, c.ahead, xb);
      for (int p = 0; p < c.manifold.count; ++p) {
        const Vec3& x = c.manifold.points[p].position;
        const double a = passes(ka, c.manifold.part_a, at_a, turn_a, x, n);
        in.kept[p].set(lane, T(a - passes(kb, c.manifold.part_b, at_b, turn_b, x, n)));
      }
    }
    if (slot_[c.a] != kNoBody) {
      const ScaledBody& b = scaled_[slot_[c.a]];
      g.a[lane] = slot_[c.a], in.root_a.set(lane, T(b.root));
      for (int e = 0; e < 9; ++e) in.turn_a[e].set(lane, T(b.turn[e]));
    }
    if (slot_[c.b] != kNoBody) {
      const ScaledBody& b = scaled_[slot_[c.b]];
      g.b[lane] = slot_[c.b], in.root_b.set(lane, T(b.root));
      for (int e = 0; e < 9; ++e) in.turn_b[e].set(lane, T(b.turn[e]));
    }
    const double friction = std::sqrt(ka.friction * kb.friction);
    in.friction.set(lane, T(friction));
    in.restitution.set(lane, T(std::max(ka.restitution, kb.restitution)));
    in.spinning.set(lane, T(std::max(ka.spin_arm(friction), kb.spin_arm(friction))));
    const double rolling = std::max(ka.rolling, kb.rolling);
    in.rolling.set(lane, T(rolling));
    set3(in.slide, lane, c.slide), set3(in.roll, lane, c.roll);
    in.twist.set(lane, T(c.twist));
    if (rolling > 0) g.flags |= ContactGroup<T>::kRolls;
    if (ka.restitution > 0 || kb.restitution > 0) g.flags |= ContactGroup<T>::kBounces;
    Vec3 surface, turn;
    if (now[c.b].part == BodyNow::Part::kinematic) {
      turn = load3(w, c.b), surface = load3(v, c.b) - cross(turn, xb - xa);
    }
    if (now[c.a].part == BodyNow::Part::kinematic) turn -= load3(w, c.a), surface -= load3(v, c.a);
    if (ka.conveys() || kb.conveys()) {
      const Vec3 belt =
          now[c.b].at.direction(kb.surface_velocity) - now[c.a].at.direction(ka.surface_velocity);
      surface += belt - n * dot(belt, n);
    }
    // What a motor turns carries other bodies as what is moved from outside.
    const bool carries = turn != Vec3{} || (!driven_.empty() && g.a[lane] != end && g.b[lane] != end &&
                                            (driven_[g.a[lane]] || driven_[g.b[lane]]));
    if (carries) {
      g.flags |= ContactGroup<T>::kDrifts | ContactGroup<T>::kTurns;
      const CarriedPair pair{&ka, &kb, &now[c.a], &now[c.b], load3(v, c.a), load3(v, c.b), turn_a, turn_b};
      const carried::Carried carried = carried_velocity(c, pair, pressed_center(c) - xa, h);
      const Vec3 first = carried.mean - carried.rate * (0.5 * h);
      set3(in.carried, lane, first), set3(in.carried_rate, lane, carried.rate);
      if (carried.lies) {
        in.lies.set(lane, 1);
        const double lift = dot(first, n), rate = dot(carried.rate, n);
        in.lift.set(lane, T(lift)), in.lift_rate.set(lane, T(rate));
        // What was found ahead was brought back without it.
        const double missed = c.ahead * (lift + 0.5 * rate * c.ahead);
        for (int p = 0; p < c.manifold.count; ++p)
          in.separation[p].set(lane, T(double(in.separation[p][lane]) - missed));
      }
      set3(in.slide, lane, rotation(free_rotation::turn(carried.turns * h)).apply(c.slide));
    }
    if ((slot_[c.a] == kNoBody || slot_[c.b] == kNoBody) && (is_led(rested, c.a) || is_led(rested, c.b))) {
      g.flags |= ContactGroup<T>::kDrifts | ContactGroup<T>::kTurns;
      const Vec3 center = pressed_center(c),
                 rate = led_rate(s, c.b, center - xb) - led_rate(s, c.a, center - xa),
                 first = rate * (-0.5 * h);  // the velocities are the means of the step
      set3(in.carried, lane, get3(in.carried, lane) + first);
      set3(in.carried_rate, lane, get3(in.carried_rate, lane) + rate);
      in.lift.set(lane, T(in.lift[lane] + dot(first, n)));
      in.lift_rate.set(lane, T(in.lift_rate[lane] + dot(rate, n)));
    }
    if (surface != Vec3{} || turn != Vec3{}) {
      g.flags |= ContactGroup<T>::kDrifts;
      set3(in.surface, lane, surface), set3(in.surface_turn, lane, turn);
    }
  }
  prepare_contacts(g, in);
}

template <class T>
void ContactSolver<T>::store_impulses(std::span<Contact* const> contacts, const PenetrationOffsetRule& rule) {
  const auto store = [&](size_t k) {
    const ContactGroup<T>& g = groups_[k];
    for (int lane = 0; lane < W::kLanes; ++lane) {
      const uint32_t m = contact_lanes_.member[k * W::kLanes + lane];
      if (m == kNoBody) continue;
      Contact& c = *contacts[m];
      double sum = 0, depth = 0;
      for (int p = 0; p < c.manifold.count; ++p) {
        c.impulse[p] = g.place[p].impulse[lane];
        sum += c.impulse[p], depth -= c.impulse[p] * c.manifold.points[p].separation;
      }
      const double a = g.root_a[lane], b = g.root_b[lane];
      c.penetration_offset =
          sum > 0 ? next_penetration_offset(c.penetration_offset, depth / sum, sum * (a * a + b * b), rule)
                  : 0;
      // At most the offset: a contact that lost its load holds up no point.
      for (double& u : c.uneven) u = std::clamp(u, -c.penetration_offset, c.penetration_offset);
      c.slide = get3(g.tangent[0], lane) * g.slide[0][lane] + get3(g.tangent[1], lane) * g.slide[1][lane];
      c.twist = g.twist[lane];
      if (g.flags & ContactGroup<T>::kRolls) {
        c.roll = get3(g.tangent[0], lane) * g.roll[0][lane] + get3(g.tangent[1], lane) * g.roll[1][lane];
      }
    }
  };
  team_.for_blocks(contact_lanes_.count, kGroupsPerBlock, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) store(k);
  });
}

template void ContactSolver<float>::fill(size_t, std::span<Contact* const>, const State&,
                                         std::span<const BodyKind>, std::span<const BodyNow>, double);
template void ContactSolver<double>::fill(size_t, std::span<Contact* const>, const State&,
                                          std::span<const BodyKind>, std::span<const BodyNow>, double);
template void ContactSolver<float>::store_impulses(std::span<Contact* const>, const PenetrationOffsetRule&);
template void ContactSolver<double>::store_impulses(std::span<Contact* const>, const PenetrationOffsetRule&);

}  // namespace truestep::rigid3d
