// Positions and velocities of the nodes, and the articulated body algorithm (table 7.1) in three passes:
// outwards for velocities and bias forces, inwards for articulated inertias, outwards for accelerations.
// Every joint's motion subspace is constant in the node's frame, so the book's c_J is 0.
#include "engine/systems/articulation/tree.h"

#include <algorithm>

#include "engine/math/trig.h"
#include "engine/systems/articulation/frames.h"

namespace truestep::articulation {

using spatial::ArticulatedInertia;
using spatial::Force;
using spatial::Frame;
using spatial::Matrix;
using spatial::Motion;
using spatial::Symmetric;

namespace {

constexpr Rotation product(const Rotation& a, const Rotation& b) {
  return {{b.apply_inverse(a.row[0]), b.apply_inverse(a.row[1]), b.apply_inverse(a.row[2])}};
}

// Rodrigues' formula for a unit axis.
Rotation turn(const Vec3& a, double angle) {
  const auto [s, c] = trig::sincos(angle);
  const Vec3 k = a * (1 - c), sa = a * s;
  return {{{c + k.x * a.x, k.x * a.y - sa.z, k.x * a.z + sa.y},
           {k.y * a.x + sa.z, c + k.y * a.y, k.y * a.z - sa.x},
           {k.z * a.x - sa.y, k.z * a.y + sa.x, c + k.z * a.z}}};
}

// For q / |q|: the stages of an integrator leave the unit sphere.
Rotation turn(const double* q) {
  const double n = 2 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  return {{{1 - n * (y * y + z * z), n * (x * y - w * z), n * (x * z + w * y)},
           {n * (x * y + w * z), 1 - n * (x * x + z * z), n * (y * z - w * x)},
           {n * (x * z - w * y), n * (y * z + w * x), 1 - n * (x * x + y * y)}}};
}

// S v, also S v'.
Motion joint_motion(const Node& n, const double* v) {
  switch (n.move) {
    case Move::revolute:
      return {n.axis * v[n.v], {}};
    case Move::prismatic:
      return {{}, n.axis * v[n.v]};
    case Move::spherical:
      return {load3(v + n.v, 0), {}};
    case Move::translation:
      return {{}, load3(v + n.v, 0)};
    case Move::fixed:
      break;
  }
  return {};
}

// Writes S^T f to tau.
void joint_effort(const Node& n, const Force& f, double* tau) {
  switch (n.move) {
    case Move::revolute:
      tau[n.v] = dot(n.axis, f.n);
      return;
    case Move::prismatic:
      tau[n.v] = dot(n.axis, f.f);
      return;
    case Move::spherical:
      return store3(tau + n.v, 0, f.n);
    case Move::translation:
      return store3(tau + n.v, 0, f.f);
    case Move::fixed:
      return;
  }
}

// C - B^T D B.
Symmetric reduced(const Symmetric& c, const Symmetric& d, const Matrix& b) {
  const auto column = [&](int j) {
    const auto at = [&](const Vec3& r) { return j == 0 ? r.x : j == 1 ? r.y : r.z; };
    return Vec3{at(b.row[0]), at(b.row[1]), at(b.row[2])};
  };
  const Vec3 x = column(0), y = column(1), z = column(2), dx = d * x, dy = d * y, dz = d * z;
  return {c.xx - dot(x, dx), c.yy - dot(y, dy), c.zz - dot(z, dz),
          c.xy - dot(x, dy), c.xz - dot(x, dz), c.yz - dot(y, dz)};
}
constexpr Matrix transposed(const Matrix& m) {
  return {{{m.row[0].x, m.row[1].x, m.row[2].x},
           {m.row[0].y, m.row[1].y, m.row[2].y},
           {m.row[0].z, m.row[1].z, m.row[2].z}}};
}

// Articulated inertia and bias force that the node passes to its parent, in its own frame.
struct Shown {
  ArticulatedInertia inertia;
  Force p;
};
Shown show_parent(const Node& n, NodeWork& w, const double* tau) {
  const ArticulatedInertia& I = w.inertia;
  switch (n.move) {
    case Move::revolute:
    case Move::prismatic: {
      const bool turns = n.move == Move::revolute;
      w.U = turns ? Force{I.A * n.axis, I.B.transposed_times(n.axis)} : Force{I.B * n.axis, I.C * n.axis};
      const double d = 1 / dot(n.axis, turns ? w.U.n : w.U.f);
      const double u = tau[n.v] - dot(n.axis, turns ? w.p.n : w.p.f);
      w.Dinv.xx = d, w.u.x = u;
      Shown s{{spatial::minus_outer(I.A, w.U.n, d), I.B, spatial::minus_outer(I.C, w.U.f, d)}, w.p};
      s.inertia.B.row[0] -= w.U.f * (d * w.U.n.x);
      s.inertia.B.row[1] -= w.U.f * (d * w.U.n.y);
      s.inertia.B.row[2] -= w.U.f * (d * w.U.n.z);
      s.p += s.inertia * w.c;
      s.p += Force{w.U.n * (d * u), w.U.f * (d * u)};
      return s;
    }
    case Move::spherical: {
      w.Dinv = inverse(I.A), w.u = load3(tau + n.v, 0) - w.p.n;
      const Symmetric C = reduced(I.C, w.Dinv, I.B);
      return {{{}, {}, C}, {load3(tau + n.v, 0), w.p.f + C * w.c.v + I.B.transposed_times(w.Dinv * w.u)}};
    }
    case Move::translation: {
      w.Dinv = inverse(I.C), w.u = load3(tau + n.v, 0) - w.p.f;
      const Symmetric A = reduced(I.A, w.Dinv, transposed(I.B));
      return {{A, {}, {}}, {w.p.n + A * w.c.w + I.B * (w.Dinv * w.u), load3(tau + n.v, 0)}};
    }
    case Move::fixed:
      break;
  }
  return {I, w.p};
}

// v' of the node's joint if its parent's side accelerates with `a`; completes w.a.
void give_way(const Node& n, NodeWork& w, const Motion& a, double* qdd) {
  w.a = a;
  switch (n.move) {
    case Move::revolute:
    case Move::prismatic: {
      const double x = w.Dinv.xx * (w.u.x - spatial::dot(a, w.U));
      qdd[n.v] = x;
      (n.move == Move::revolute ? w.a.w : w.a.v) += n.axis * x;
      return;
    }
    case Move::spherical: {
      w.a.w = w.Dinv * (w.u - w.inertia.B * a.v);
      return store3(qdd + n.v, 0, w.a.w - a.w);
    }
    case Move::translation: {
      w.a.v = w.Dinv * (w.u - w.inertia.B.transposed_times(a.w));
      return store3(qdd + n.v, 0, w.a.v - a.v);
    }
    case Move::fixed:
      return;
  }
}

}  // namespace

Frame node_frame(const Node& n, const double* q) {
  switch (n.move) {
    case Move::revolute:
      return {product(n.frame.R, turn(n.axis, q[n.q])), n.frame.p};
    case Move::prismatic:
      return {n.frame.R, n.frame.p + n.frame.R.apply(n.axis * q[n.q])};
    case Move::spherical:
      return {product(n.frame.R, turn(q + n.q)), n.frame.p};
    case Move::translation:
      return {n.frame.R, n.frame.p + n.frame.R.apply(load3(q + n.q, 0))};
    case Move::fixed:
      break;
  }
  return n.frame;
}

int32_t Tree::add(Node node) {
  node.q = positions, node.v = velocities;
  positions += positions_of(node.move), velocities += velocities_of(node.move);
  nodes.push_back(node);
  return static_cast<int32_t>(nodes.size()) - 1;
}

void move(const Tree& tree, std::span<const double> q, std::span<const double> v, std::span<NodeWork> work) {
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    const Node& n = tree.nodes[i];
    NodeWork& w = work[i];
    w.frame = node_frame(n, q.data());
    const Motion own = v.empty() ? Motion{} : joint_motion(n, v.data());
    w.v = n.parent == kGround ? own : w.frame.into(work[size_t(n.parent)].v) + own;
    w.c = cross(w.v, own);
  }
}

void velocities(const Tree& tree, std::span<const double> v, std::span<NodeWork> work) {
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    const Node& n = tree.nodes[i];
    NodeWork& w = work[i];
    const Motion own = joint_motion(n, v.data());
    w.v = n.parent == kGround ? own : w.frame.into(work[size_t(n.parent)].v) + own;
  }
}

void accelerations(const Tree& tree, std::span<const double> q, std::span<const double> v,
                   std::span<const double> tau, const Vec3& gravity, std::span<const Push> pushes,
                   std::span<NodeWork> work, std::span<double> qdd) {
  const size_t n = tree.nodes.size();
  move(tree, q, v, work);
  for (size_t i = 0; i < n; ++i) {
    const spatial::Inertia& I = tree.nodes[i].inertia;
    work[i].inertia = articulated(I);
    work[i].p = cross(work[i].v, I * work[i].v);
  }
  for (const Push& push : pushes) {
    if (push.node == kGround) continue;
    Vec3 f = push.force, t = push.torque;
    if (push.axes == Push::Axes::world) {
      const Rotation R = world_frame(tree, work, push.node).R;
      f = R.apply_inverse(f), t = R.apply_inverse(t);
    }
    Force& p = work[size_t(push.node)].p;
    p = p - Force{cross(push.at, f) + t, f};
  }
  for (size_t i = n; i-- > 0;) {
    const Node& node = tree.nodes[i];
    const Shown s = show_parent(node, work[i], tau.data());
    if (node.parent == kGround) continue;
    NodeWork& parent = work[size_t(node.parent)];
    parent.inertia += out(work[i].frame, s.inertia);
    parent.p += work[i].frame.out(s.p);
  }
  // Gravity is an acceleration of the ground, so no node needs its orientation in the world.
  const Motion ground{{}, -gravity};
  for (size_t i = 0; i < n; ++i) {
    const Node& node = tree.nodes[i];
    const Motion& from = node.parent == kGround ? ground : work[size_t(node.parent)].a;
    give_way(node, work[i], work[i].frame.into(from) + work[i].c, qdd.data());
  }
}

Force joint_force(const NodeWork& w) {
  return w.inertia * w.a + w.p;
}

void inverse_dynamics(const Tree& tree, std::span<const double> q, std::span<const double> v,
                      std::span<const double> qdd, const Vec3& gravity, std::span<NodeWork> work,
                      std::span<double> tau) {
  move(tree, q, v, work);
  const Motion ground{{}, -gravity};
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    const Node& n = tree.nodes[i];
    NodeWork& w = work[i];
    const Motion& from = n.parent == kGround ? ground : work[size_t(n.parent)].a;
    w.a = w.frame.into(from) + w.c + joint_motion(n, qdd.data());
    w.p = n.inertia * w.a + cross(w.v, n.inertia * w.v);
  }
  for (size_t i = tree.nodes.size(); i-- > 0;) {
    const Node& n = tree.nodes[i];
    joint_effort(n, work[i].p, tau.data());
    if (n.parent != kGround) work[size_t(n.parent)].p += work[i].frame.out(work[i].p);
  }
}

void mass_matrix(const Tree& tree, std::span<const double> q, std::span<NodeWork> work, std::span<double> M) {
  const size_t size = tree.velocities;
  move(tree, q, {}, work);
  std::fill(M.begin(), M.end(), 0.0);
  for (size_t i = 0; i < tree.nodes.size(); ++i) work[i].inertia = articulated(tree.nodes[i].inertia);
  for (size_t i = tree.nodes.size(); i-- > 0;) {
    const Node& n = tree.nodes[i];
    if (n.parent != kGround) work[size_t(n.parent)].inertia += out(work[i].frame, work[i].inertia);
    // The force that gives everything beyond joint i a unit acceleration along one of its directions,
    // projected on the joints on the path to the ground.
    for (uint32_t k = 0; k < velocities_of(n.move); ++k) {
      double unit[3] = {0, 0, 0}, felt[3];
      unit[k] = 1;
      Node local = n;
      local.v = 0;
      Force f = work[i].inertia * joint_motion(local, unit);
      for (int32_t j = static_cast<int32_t>(i); j != kGround; j = tree.nodes[size_t(j)].parent) {
        local = tree.nodes[size_t(j)];
        const uint32_t row = local.v;
        local.v = 0;
        joint_effort(local, f, felt);
        for (uint32_t l = 0; l < velocities_of(local.move); ++l) {
          M[(row + l) * size + n.v + k] = M[(n.v + k) * size + row + l] = felt[l];
        }
        f = work[size_t(j)].frame.out(f);
      }
    }
  }
}

void position_rate(const Tree& tree, std::span<const double> q, std::span<const double> v,
                   std::span<double> rate) {
  for (const Node& n : tree.nodes) {
    if (n.move == Move::spherical) {
      const double* o = q.data() + n.q;
      const Vec3 w = load3(v.data() + n.v, 0);
      const Quat d = Quat{o[0], o[1], o[2], o[3]} * Quat{0, 0.5 * w.x, 0.5 * w.y, 0.5 * w.z};
      rate[n.q] = d.w, store3(rate.data() + n.q + 1, 0, Vec3{d.x, d.y, d.z});
    } else {
      for (uint32_t k = 0; k < velocities_of(n.move); ++k) rate[n.q + k] = v[n.v + k];
    }
  }
}

void normalise(const Tree& tree, std::span<double> q) {
  for (const Node& n : tree.nodes) {
    if (n.move != Move::spherical) continue;
    double* o = q.data() + n.q;
    const Quat u = normalized(Quat{o[0], o[1], o[2], o[3]});
    o[0] = u.w, o[1] = u.x, o[2] = u.y, o[3] = u.z;
  }
}

Frame world_frame(const Tree& tree, std::span<const NodeWork> work, int32_t node) {
  Frame f;
  for (; node != kGround; node = tree.nodes[size_t(node)].parent) {
    const Frame& x = work[size_t(node)].frame;
    f = {product(x.R, f.R), x.R.apply(f.p) + x.p};
  }
  return f;
}

// Velocities add up from the node to the ground: a joint adds v + w x r at the point.
BodyMotion link_motion(const Tree& tree, std::span<const double> q, std::span<const double> v, int32_t node,
                       const Vec3& center) {
  Frame f;
  Motion sum;
  Vec3 place = center;
  Vec3 velocity;
  for (int32_t i = node; i != kGround; i = tree.nodes[size_t(i)].parent) {
    const Node& n = tree.nodes[size_t(i)];
    const Motion own = joint_motion(n, v.data());
    velocity += own.v + truestep::cross(own.w, place);
    sum.w += own.w;
    // On to the parent's frame.
    const Frame x = node_frame(n, q.data());
    place = x.R.apply(place) + x.p;
    velocity = x.R.apply(velocity), sum.w = x.R.apply(sum.w);
    f = {product(x.R, f.R), {}};
  }
  return {place, quaternion(f.R), velocity, sum.w};
}

void world_frames(const Tree& tree, std::span<const NodeWork> work, std::span<Frame> out) {
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    const Frame& x = work[i].frame;
    const int32_t parent = tree.nodes[i].parent;
    if (parent == kGround) {
      out[i] = x;
    } else {
      const Frame& b = out[size_t(parent)];
      out[i] = {product(b.R, x.R), b.R.apply(x.p) + b.p};
    }
  }
}

}  // namespace truestep::articulation
