#include "engine/systems/articulation/carried_links.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/kernels/animation/joint_tree.h"
#include "engine/math/trig.h"
#include "engine/systems/articulation/frames.h"

namespace truestep::articulation {

namespace {

using animation::conjugate;
using animation::operator*;
using animation::rotate;

constexpr double kTurn = 6.283185307179586;

/// Pose b relative to a.
Pose seen_from(const Pose& a, const Pose& b) {
  const Quat back = conjugate(a.orientation);
  return {rotate(back, b.position - a.position), normalized(back * b.orientation)};
}
Pose pose_of(const spatial::Frame& f) {
  return {f.p, quaternion(f.R)};
}

/// The turn about a that brings b closest to q b.
double turn_between(const Vec3& a, const Vec3& b, const Quat& q) {
  const Vec3 to = rotate(q, b);
  const Vec3 from_across = b - a * dot(a, b), to_across = to - a * dot(a, to);
  return trig::atan2(dot(a, cross(from_across, to_across)), dot(from_across, to_across));
}

/// Coordinates of one node that bring it closest to `to`, in its joint's frame. `next` is the node that
/// follows in the same joint, or null.
void reach(const Node& n, const Node* next, const Pose& to, double* q) {
  switch (n.move) {
    case Move::revolute: {
      const double angle = next ? turn_between(n.axis, next->axis, to.orientation)
                                : animation::swing_twist(to.orientation, n.axis).twist;
      // Joints that have turned more than once continue from that turn.
      q[n.q] = angle + kTurn * std::nearbyint((q[n.q] - angle) / kTurn);
      return;
    }
    case Move::prismatic:
      q[n.q] = dot(n.axis, to.position);
      return;
    case Move::translation:
      return store3(q + n.q, 0, to.position);
    case Move::spherical: {
      const Quat t = animation::nearer({q[n.q], q[n.q + 1], q[n.q + 2], q[n.q + 3]}, to.orientation);
      q[n.q] = t.w, store3(q + n.q + 1, 0, Vec3{t.x, t.y, t.z});
      return;
    }
    case Move::fixed:
      return;
  }
}

}  // namespace

void carry_links(const Model& m, std::span<const BodyMotion> to, std::span<const uint8_t> given,
                 std::span<double> q, std::span<double> v, CarryWork& w) {
  const std::vector<Node>& nodes = m.tree.nodes;
  w.poses.resize(m.links.size()), w.twists.resize(m.links.size());
  w.pushes.clear();
  for (size_t i = 0; i < m.links.size(); ++i) {
    const Link& l = m.links[i];
    const bool grounded = l.parent == kGround;
    const int32_t before = grounded ? kGround : m.links[size_t(l.parent)].node;
    Pose here = grounded ? Pose{} : w.poses[size_t(l.parent)];
    const Pose wanted{to[i].place - rotate(to[i].orientation, l.center), to[i].orientation};
    // A joint has at most two nodes.
    const int32_t first = nodes[size_t(l.node)].parent == before ? l.node : nodes[size_t(l.node)].parent;
    for (int32_t k = first;; k = l.node) {
      const Node& n = nodes[size_t(k)];
      const Node* next =
          k != l.node && nodes[size_t(l.node)].move == Move::revolute ? &nodes[size_t(l.node)] : nullptr;
      if (given[i]) reach(n, next, seen_from(here * pose_of(n.frame), wanted), q.data());
      here = here * pose_of(node_frame(n, q.data()));
      if (k == l.node) break;
    }
    w.poses[i] = here;
    BodyTwist& twist = w.twists[i];
    twist = {to[i].velocity, to[i].spin};
    if (!given[i]) {
      twist = {};
      if (!grounded) {
        const auto parent = size_t(l.parent);
        const Vec3 arm = here.position + rotate(here.orientation, l.center) - w.poses[parent].position -
                         rotate(w.poses[parent].orientation, m.links[parent].center);
        twist = w.twists[parent];
        twist.velocity += cross(twist.spin, arm);
      }
    }
    const Quat back = conjugate(here.orientation);
    const Vec3 spin = rotate(back, twist.spin);
    const spatial::Force momentum =
        nodes[size_t(l.node)].inertia *
        spatial::Motion{spin, rotate(back, twist.velocity) - cross(spin, l.center)};
    w.pushes.push_back(
        {.node = l.node, .at = {}, .force = momentum.f, .torque = momentum.n, .axes = Push::Axes::node});
  }
  w.none.assign(m.tree.velocities, 0.0);
  w.work.resize(nodes.size());
  if (m.closures.empty()) {
    accelerations(m.tree, q, {}, w.none, {}, w.pushes, w.work, v);
    return;
  }
  closed_accelerations(m.tree, m.closures, q, {}, w.none, {}, w.pushes, w.work, w.closures, v);
  close(m.tree, m.closures, q, v, w.closures);
}

}  // namespace truestep::articulation
