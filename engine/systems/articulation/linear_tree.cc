// The nodes' own parts of a tree's linearised motion (tree_newton.h).
#include <algorithm>

#include "engine/systems/articulation/tree_newton.h"

namespace truestep::articulation {

using spatial::Force;
using spatial::Motion;

namespace {

void put(double (*column)[3], size_t k, const Motion& m) {
  const double c[] = {m.w.x, m.w.y, m.w.z, m.v.x, m.v.y, m.v.z};
  for (size_t r = 0; r < 6; ++r) column[r][k] = c[r];
}
void put(double (*matrix)[kMotionsAndPose], size_t k, const Force& f) {
  const double c[] = {f.n.x, f.n.y, f.n.z, f.f.x, f.f.y, f.f.z};
  for (size_t r = 0; r < 6; ++r) matrix[r][k] = c[r];
}

Vec3 unit_axis(size_t k) {
  return {k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0};
}

// Column k of the joint's motion subspace.
Motion direction(const Node& n, size_t k) {
  switch (n.move) {
    case Move::revolute:
      return {n.axis, {}};
    case Move::prismatic:
      return {{}, n.axis};
    case Move::spherical:
      return {unit_axis(k), {}};
    case Move::translation:
      return {{}, unit_axis(k)};
    case Move::fixed:
      break;
  }
  return {};
}

Motion less(const Motion& a, const Motion& b) {
  return {a.w - b.w, a.v - b.v};
}

}  // namespace

void LinearTree::linearise(const Tree& tree, std::span<const double> q, std::span<const double> v,
                           std::span<const double> qdd, std::span<const NodeWork> work,
                           std::span<const Push> pushes, std::span<const DriveSlope> drives) {
  nodes_.resize(tree.nodes.size());
  const auto in_world = [](const Push& p) { return p.node != kGround && p.axes == Push::Axes::world; };
  width_ = std::ranges::any_of(pushes, in_world) ? kMotionsAndPose : kMotions;
  for (size_t i = 0; i < nodes_.size(); ++i) {
    const Node& n = tree.nodes[i];
    const NodeWork& w = work[i];
    NodeSlope& s = nodes_[i];
    s.frame = w.frame, s.move = n.move, s.parent = n.parent, s.q = n.q, s.v = n.v, s.drive = drives[i];
    const size_t m = velocities_of(n.move);
    Motion moved, driven;  // S v and S v'
    for (size_t k = 0; k < m; ++k) {
      const Motion d = direction(n, k);
      moved += {d.w * v[n.v + k], d.v * v[n.v + k]};
      driven += {d.w * qdd[n.v + k], d.v * qdd[n.v + k]};
    }
    s.joint = moved;
    const Motion seen_v = less(w.v, moved), seen_a = less(less(w.a, w.c), driven);
    const Force through = joint_force(w);
    for (size_t k = 0; k < m; ++k) {
      const Motion d = direction(n, k);
      put(s.S, k, d);
      put(s.with_p, k, cross(seen_v, d));
      put(s.with_p + 6, k, cross(seen_a, d));
      put(s.with_p + 12, k, d);
      put(s.with_v, k, d);
      put(s.with_v + 6, k, cross(w.v, d));
      put(s.with_v + 12, k, Motion{});
      const Force f = cross(d, through);
      const double c[] = {f.n.x, f.n.y, f.n.z, f.f.x, f.f.y, f.f.z};
      for (size_t r = 0; r < 6; ++r) s.turned[r][k] = c[r];
    }
    const Force momentum = n.inertia * w.v;
    for (size_t k = 0; k < 6; ++k) {
      const Motion e = k < 3 ? Motion{unit_axis(k), {}} : Motion{{}, unit_axis(k - 3)};
      const Force inertial = n.inertia * e;
      put(s.own, k, cross(e, momentum) + cross(w.v, inertial));
      put(s.own, 6 + k, inertial);
      put(s.own, 12 + k, Force{});
    }
    if (n.move == Move::spherical) {
      std::copy_n(q.data() + n.q, 4, s.orientation);
      std::copy_n(v.data() + n.v, 3, s.spin);
    }
  }
  if (width_ == kMotions) return;
  // A force with a fixed direction in the world turns relative to the node: f x xi.
  frames_.resize(nodes_.size());
  world_frames(tree, work, frames_);
  for (const Push& push : pushes) {
    if (!in_world(push)) continue;
    const Rotation& R = frames_[size_t(push.node)].R;
    const Vec3 f = R.apply_inverse(push.force), t = R.apply_inverse(push.torque);
    auto& own = nodes_[size_t(push.node)].own;
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 df = cross(f, unit_axis(k)), dt = cross(push.at, df) + cross(t, unit_axis(k));
      const double c[] = {dt.x, dt.y, dt.z, df.x, df.y, df.z};
      for (size_t r = 0; r < 6; ++r) own[r][12 + k] -= c[r];
    }
  }
}

}  // namespace truestep::articulation
