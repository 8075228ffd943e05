// Contacts of bodies that are apart at the start of a step and that a body moved from outside (kinematic,
// or led by a path) would pass within it. The time of impact on the motion without contacts gives the poses
// at which the contact is found; brought back from there (foreseen_manifold.h), it is one that the solver
// closes within the step. Fast bodies that forces move are stopped after the step (rigid3d_stages.cc).
#include "engine/rigid/toi_clamp.h"
#include "engine/systems/rigid3d/contacts.h"
#include "engine/systems/rigid3d/turned_surface.h"

namespace truestep::rigid3d {
namespace {

/// The share of a body's margin at which two bodies meet.
constexpr double kGap = 0.25;

struct Course {
  Sweep sweep;
  Vec3 velocity, spin;
};

/// m that any point of `b` moves in h (s), seen from `a`, at most.
double way(const Course& a, const Course& b, double reach, double h) {
  const Vec3 arm = b.sweep.from.position - a.sweep.from.position;
  return h * (norm(b.velocity - a.velocity - cross(a.spin, arm)) + norm(b.spin - a.spin) * reach);
}

}  // namespace

bool ContactList::meet(const State& s, std::span<const BodyKind> kinds, const BodyPair& pair, double h,
                       Outlook& out) const {
  const bool a_drives = bodies_[pair.a].part == BodyNow::Part::kinematic;
  const uint32_t drives = a_drives ? pair.a : pair.b, driven = a_drives ? pair.b : pair.a;
  const auto kind = s.span<uint32_t>(columns::kind);
  const BodyKind &a = kinds[kind[pair.a]], &b = kinds[kind[pair.b]], &hit = kinds[kind[driven]];
  if (bodies_[drives].part != BodyNow::Part::kinematic || !bodies_[driven].gives_way()) return false;
  if (a.sensor || b.sensor) return false;
  // Nothing comes out on the other side of a half-space.
  if (a.solid.kind == SolidKind::plane || b.solid.kind == SolidKind::plane) return false;
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  const auto course = [&](uint32_t i) {
    const Vec3 velocity = load3(v, i), spin = load3(w, i);
    return Course{{{load3(x, i), load_quat(q, i)}, velocity * h, spin * h}, velocity, spin};
  };
  const Course from = course(pair.a), to = course(pair.b);
  const double moved = a_drives ? way(from, to, hit.reach, h) : way(to, from, hit.reach, h);
  if (!may_pass_through(moved, hit.inner)) return false;
  const auto impact = time_of_impact(a.solid, from.sweep, b.solid, to.sweep, kGap * bodies_[driven].margin);
  if (!impact || impact->t == 0) return false;
  const auto motion = [&](const BodyKind& k, uint32_t i, const Course& c) {
    return SpaceMotion{c.velocity, seen_spin(k, bodies_[i].at.rotation, c.spin)};
  };
  out.ahead = impact->t * h;
  out.of_a = motion(a, pair.a, from), out.of_b = motion(b, pair.b, to);
  out.a = from.sweep.at(impact->t), out.b = to.sweep.at(impact->t);
  return true;
}

}  // namespace truestep::rigid3d
