#include "engine/systems/rigid3d/solver/solver_carried.h"

#include <algorithm>
#include <cmath>

#include "engine/geometry/compound.h"
#include "engine/kernels/rigid/free_rotation.h"
#include "engine/systems/rigid3d/solver/solver.h"

namespace truestep::rigid3d {
namespace {

/// Cosine between a cylinder's axis and a normal from which on its face is touched, not its side.
constexpr double kOnFace = 0.9;

/// Of a body at a contact: whether it is round there, and the spin at which the place goes round with it.
struct Place {
  bool round = false;
  Vec3 turns;
};
Place place(const BodyKind& kind, uint32_t part, const Transform& at, const Vec3& spin, const Vec3& n) {
  const Solid* solid = &kind.solid;
  Transform own = at;
  if (solid->kind == SolidKind::compound) {
    const Compound::Part& p = solid->compound->parts()[part];
    solid = &p.solid, own = own * p.place;
  }
  if (solid->kind == SolidKind::sphere) return {true, {}};
  if (solid->kind != SolidKind::cylinder && solid->kind != SolidKind::capsule) return {false, spin};
  const Vec3 along = axis(own.rotation, 1);
  if (solid->kind == SolidKind::cylinder && std::abs(dot(along, n)) > kOnFace) return {false, spin};
  return {true, spin - along * dot(along, spin)};
}

}  // namespace

carried::Carried carried_velocity(const Contact& c, const CarriedPair& p, const Vec3& center, double h) {
  const Vec3 &n = c.manifold.normal, &xa = p.now_a->at.position, &xb = p.now_b->at.position;
  const Place on_a = place(*p.kind_a, c.manifold.part_a, p.now_a->at, p.spin_a, n),
              on_b = place(*p.kind_b, c.manifold.part_b, p.now_b->at, p.spin_b, n);
  // Where two round bodies touch, neither tells where the place goes.
  if (on_a.round && on_b.round) return {};
  const bool moved_a = p.now_a->part == BodyNow::Part::active,
             moved_b = p.now_b->part == BodyNow::Part::active;
  // The place goes with what is round, or with the smaller body: it stands on the larger one.
  const bool with_b = on_a.round != on_b.round ? on_b.round
                      : moved_a != moved_b     ? moved_b
                                               : p.kind_b->reach < p.kind_a->reach;
  const Vec3 turns = with_b ? on_b.turns : on_a.turns, leads = with_b ? p.velocity_b : p.velocity_a;
  const Vec3 solved_a = center, solved_b = center + xa - xb - c.apart;
  // Back to the start of the step, with the body that the place goes with.
  const Vec3 from = with_b ? solved_b : solved_a;
  const Vec3 back = c.ahead > 0 ? rotation(free_rotation::turn(turns * -c.ahead)).apply(from) : from;
  const Vec3 arm_a = with_b ? back + xb - xa : back, arm_b = with_b ? back : back + xa - xb;
  // A body that rolls on the other turns its velocity by this share of the change of what is under it.
  const BodyKind& leader = with_b ? *p.kind_b : *p.kind_a;
  const double inertia = leader.mass * norm2(back);
  const bool rolls = (with_b ? on_b : on_a).round && (with_b ? moved_b : moved_a);
  const double follows = rolls ? leader.moments.y / (leader.moments.y + inertia) : 0;
  const auto excess = [&](const Vec3& spin, const Vec3& arm, const Vec3& solved, const Vec3& velocity) {
    // m/s at which the place leaves an arm of this body that goes round at the place's rate.
    Vec3 drift = leads + cross(turns, back) - velocity - cross(turns, arm);
    drift += cross(spin, drift) * (0.5 * h * follows);
    return carried::excess(spin, arm, solved, turns, drift, h);
  };
  const carried::Carried a = excess(p.spin_a, arm_a, solved_a, p.velocity_a),
                         b = excess(p.spin_b, arm_b, solved_b, p.velocity_b);
  return {b.mean - a.mean, b.rate - a.rate};
}

template <class T>
void ContactSolver<T>::find_driven(const State& s, const JointList& joints) {
  driven_.clear();
  const auto bodies = s.span<uint32_t>(columns::joint_bodies);
  for (const uint32_t k : joints_.listed()) {
    const Joint& joint = joints.joints[k];
    const auto turns = [](const Drive& d) { return (d.laws & Drive::kMotor) && d.row > 2; };
    const Drive* first = joints.drives.data() + joint.first_drive;
    if (std::none_of(first, first + joint.drives, turns)) continue;
    driven_.resize(body_.size());
    for (const uint32_t i : {bodies[2 * k], bodies[2 * k + 1]}) {
      if (i != kNoBody && slot_[i] != kNoBody) driven_[slot_[i]] = 1;
    }
  }
}

// Impulses act about the axes of the start of the step, and a spin goes round with its body from there to the
// end: that of a ball, which does not go round, would be turned aside by the half of what friction gave it,
// and what rolls on a turntable would leave its circle.
template <class T>
void ContactSolver<T>::find_carried() {
  carried_.clear();
  if (!(flags_ & ContactGroup<T>::kTurns)) return;
  carried_.assign(body_.size() + 1, 0);
  for (size_t g = 0; g < contact_lanes_.count; ++g) {
    if (!(groups_[g].flags & ContactGroup<T>::kTurns)) continue;
    for (int lane = 0; lane < W::kLanes; ++lane)
      carried_[groups_[g].a[lane]] = carried_[groups_[g].b[lane]] = 1;
  }
  for (size_t k = 0; k < body_.size(); ++k) {
    const Vec3& m = moments_[k];
    carried_[k] = carried_[k] && m.x == m.y && m.y == m.z;
  }
}

template void ContactSolver<float>::find_driven(const State&, const JointList&);
template void ContactSolver<double>::find_driven(const State&, const JointList&);
template void ContactSolver<float>::find_carried();
template void ContactSolver<double>::find_carried();

}  // namespace truestep::rigid3d
