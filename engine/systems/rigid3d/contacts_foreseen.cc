// Loaded contacts, found where their bodies will be halfway through the substeps (foreseen_manifold.h).
#include <algorithm>
#include <cmath>

#include "engine/kernels/rigid/free_rotation.h"
#include "engine/systems/rigid3d/contacts.h"
#include "engine/systems/rigid3d/turned_surface.h"

namespace truestep::rigid3d {
namespace {

/// rad, or sizes of the smaller body: contacts of bodies that move farther are found where they are now.
/// Where the motion was followed up to there instead, 14 of 500 wheels (wheel_3d of the campaign) sank.
constexpr double kMostMotion = 0.05;

/// Largest ratio of the speed of a cylinder's surface to that of its middle past the other body: 1 if it
/// rolls. Where cylinders that spin on the spot were followed too, one of 500 (spin_3d of the campaign)
/// wandered off.
constexpr double kRolls = 2;

bool hidden_rim(const BodyKind& k, const SpaceMotion& m) {
  return k.turned_round && k.solid.kind != SolidKind::cylinder && m.spin != Vec3{};
}

}  // namespace

void ContactList::find_bearing(const State& s) {
  bears_.reserve(pairs_.capacity());
  bears_.assign(pairs_.size(), 0);
  const auto bodies = s.span<uint32_t>(columns::contact_bodies);
  const double* impulse = s.f64(columns::contact_impulse).data();
  const size_t rows = s.rows(columns::contact_bodies);
  size_t row = 0;
  const auto key = [](uint32_t a, uint32_t b) { return uint64_t{a} << 32 | b; };
  for (size_t k = 0; k < pairs_.size() && row < rows; ++k) {
    const uint64_t pair = key(pairs_[k].a, pairs_[k].b);
    if (!bodies_[pairs_[k].a].moves && !bodies_[pairs_[k].b].moves) continue;
    while (row < rows && key(bodies[2 * row], bodies[2 * row + 1]) < pair) ++row;
    for (; row < rows && key(bodies[2 * row], bodies[2 * row + 1]) == pair; ++row) {
      const double* l = impulse + 4 * row;
      if (l[0] + l[1] + l[2] + l[3] > 0) bears_[k] = 1;
    }
  }
}

void ContactList::look_ahead(const State& s, std::span<const BodyKind> kinds, const BodyPair& pair,
                             double ahead, Outlook& out) const {
  const auto kind = s.span<uint32_t>(columns::kind);
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  const BodyKind &a = kinds[kind[pair.a]], &b = kinds[kind[pair.b]];
  const bool gives_a = bodies_[pair.a].gives_way(), gives_b = bodies_[pair.b].gives_way();
  const double size = gives_a ? (gives_b ? std::min(a.reach, b.reach) : a.reach) : b.reach;
  const auto motion = [&](const BodyKind& k, uint32_t i) {
    return SpaceMotion{load3(v, i), seen_spin(k, bodies_[i].at.rotation, load3(w, i))};
  };
  out.of_a = motion(a, pair.a), out.of_b = motion(b, pair.b);
  // Seen from what turns and carries the other, where that goes round with it.
  const bool a_turns = bodies_[pair.a].part == BodyNow::Part::kinematic;
  const uint32_t turns = a_turns ? pair.a : pair.b;
  Vec3 frame = bodies_[turns].part == BodyNow::Part::kinematic ? load3(w, turns) : Vec3{};
  const Vec3 apart = bodies_[pair.b].at.position - bodies_[pair.a].at.position;
  Vec3 passing = out.of_b.velocity - out.of_a.velocity;
  const Vec3 there = passing - cross(frame, apart);
  if (norm2(there) < norm2(passing)) {
    passing = there;
    const Vec3 goes =
        (rotation(free_rotation::turn(frame * ahead)).apply(apart + passing * ahead) - apart) / ahead;
    if (a_turns) {
      out.of_b.velocity = out.of_a.velocity + goes;
    } else {
      out.of_a.velocity = out.of_b.velocity - goes;
    }
  } else {
    frame = {};
  }
  // The spin of a body's axis goes round with the body.
  const auto turn2 = [&](const BodyKind& k, uint32_t i) {
    return k.reach == k.inner ? 0 : norm2(load3(w, i) - frame);
  };
  const double way2 = std::max({turn2(a, pair.a), turn2(b, pair.b), norm2(passing) / (size * size)});
  out.ahead = 0;
  // The rims of cylinders in a compound pass their contacts about axes of their own.
  if (hidden_rim(a, out.of_a) || hidden_rim(b, out.of_b)) return;
  const double past2 = kRolls * kRolls * norm2(passing);
  const auto rolls = [&](const BodyKind& k, uint32_t i) {
    const double speed = own_spin(k, bodies_[i].at.rotation, load3(w, i) - frame) * k.solid.size.x;
    return !(speed * speed > past2);
  };
  if (!rolls(a, pair.a) || !rolls(b, pair.b)) return;
  const double seen2 = std::max(way2, norm2(frame)) * ahead * ahead;
  if (!(seen2 > kSeenMotion * kSeenMotion)) return;
  if (way2 * ahead * ahead > kMostMotion * kMostMotion) return;
  out.ahead = ahead;
  out.a = place_after(bodies_[pair.a].at, out.of_a, out.ahead);
  out.b = place_after(bodies_[pair.b].at, out.of_b, out.ahead);
}

void ContactList::bring_back(Contact& c, const Outlook& o) {
  const Vec3& n = c.manifold.normal;
  for (int p = 0; p < c.manifold.count; ++p) {
    ContactPoint& point = c.manifold.points[p];
    point.separation -= o.ahead * parting_speed(point.position, n, o.a, o.of_a, o.b, o.of_b);
    point.position -= o.of_a.velocity * o.ahead;
  }
  c.apart = (o.of_b.velocity - o.of_a.velocity) * o.ahead, c.ahead = o.ahead;
}

}  // namespace truestep::rigid3d
