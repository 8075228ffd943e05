#include "engine/systems/rigid3d/solver/solver_carried.h"

#include <algorithm>
#include <cmath>

#include "engine/geometry/compound.h"
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
  const Vec3 &n = c.manifold.normal, apart = p.now_b->at.position - p.now_a->at.position;
  const auto side = [&](const BodyKind& kind, const BodyNow& now, uint32_t part, const Vec3& v,
                        const Vec3& spin) {
    const Place at = place(kind, part, now.at, spin, n);
    return carried::Side{v,         spin,          now.part == BodyNow::Part::active,
                         at.round,  at.turns,      kind.reach,
                         kind.mass, kind.moments.y};
  };
  const carried::Side a = side(*p.kind_a, *p.now_a, c.manifold.part_a, p.velocity_a, p.spin_a),
                      b = side(*p.kind_b, *p.now_b, c.manifold.part_b, p.velocity_b, p.spin_b);
  // Where two round bodies touch, neither tells where the place goes.
  if (a.round && b.round) return {};
  const Vec3 flat = c.manifold.count > 2 ? n : Vec3{};
  return carried::velocity(a, b, {center, center - apart - c.apart, apart, c.ahead, flat}, h);
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
