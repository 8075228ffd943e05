// A tree of links in joint coordinates, which cannot drift apart:
//   M(q) q'' + h(q, q', gravity, pushes) = tau
// in O(n) both ways, without recursion: parents come before their children. A joint of the scene may be
// several nodes in a row (universal: two revolutes, free: a translation and a spherical one), all but the
// last without mass. Source: Featherstone, Rigid Body Dynamics Algorithms (2008): recursive Newton-Euler
// algorithm (table 5.1), composite rigid body algorithm (table 6.2), articulated body algorithm (table 7.1).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/kernels/rigid/spatial.h"

namespace truestep::articulation {

/// How a node moves in its joint's frame. Ball: q is a quaternion (w, x, y, z), the velocity is the angular
/// velocity in the node's own frame. Translation: along the three axes of the joint's frame.
enum class Move : uint8_t { fixed, revolute, prismatic, spherical, translation };

constexpr uint32_t positions_of(Move m) {
  return m == Move::fixed ? 0 : m == Move::spherical ? 4 : m == Move::translation ? 3 : 1;
}
constexpr uint32_t velocities_of(Move m) {
  return m == Move::fixed ? 0 : m == Move::revolute || m == Move::prismatic ? 1 : 3;
}

inline constexpr int32_t kGround = -1;

struct Node {
  Move move = Move::fixed;
  int32_t parent = kGround;  ///< an earlier node
  uint32_t q = 0, v = 0;     ///< first coordinate and velocity
  spatial::Frame frame;      ///< the joint's frame in the parent's
  Vec3 axis{0, 0, 1};        ///< unit; for revolute and prismatic, the same in both frames
  spatial::Inertia inertia;
};

/// Nodes ordered so that parents come first.
struct Tree {
  std::vector<Node> nodes;
  uint32_t positions = 0, velocities = 0;  ///< numbers in q and v

  /// Adds a node and assigns its place in q and v; returns its index.
  int32_t add(Node node);
};

/// What the algorithms keep per node.
struct NodeWork {
  spatial::Frame frame;     ///< of the node in its parent's
  spatial::Motion v, c, a;  ///< velocity, velocity-dependent acceleration, acceleration less gravity
  spatial::ArticulatedInertia inertia;
  spatial::Force p;         ///< bias force
  spatial::Force U;         ///< revolute, prismatic: inertia times axis
  spatial::Symmetric Dinv;  ///< spherical, translation: inverse of their 3 x 3 block; else xx alone
  Vec3 u;                   ///< tau - S^T p
};
using Work = std::vector<NodeWork>;

/// Force on a point of one node, and a torque about that point.
struct Push {
  int32_t node = kGround;                                        ///< kGround: none
  Vec3 at;                                                       ///< m, in the node's frame
  Vec3 force;                                                    ///< N
  Vec3 torque;                                                   ///< N m
  enum class Axes : uint8_t { world, node } axes = Axes::world;  ///< of force and torque
};

/// Frame of a node in its parent's at the tree's coordinates q.
spatial::Frame node_frame(const Node& node, const double* q);
/// Writes frames and velocities of all nodes to `work` (one element per node); empty v: at rest.
void move(const Tree& tree, std::span<const double> q, std::span<const double> v, std::span<NodeWork> work);

/// Velocities alone, after `move`; v is not empty.
void velocities(const Tree& tree, std::span<const double> v, std::span<NodeWork> work);

/// q'' of the tree under joint forces tau, by the articulated body algorithm. Leaves frames, velocities and
/// accelerations in `work`. A node without inertia in its direction gives infinities.
void accelerations(const Tree& tree, std::span<const double> q, std::span<const double> v,
                   std::span<const double> tau, const Vec3& gravity, std::span<const Push> pushes,
                   std::span<NodeWork> work, std::span<double> qdd);
/// Force and moment that the parent's side exerts on the node through the joint, in the node's frame; after
/// `accelerations`.
spatial::Force joint_force(const NodeWork& w);

/// The tau that gives the tree the accelerations qdd, by the recursive Newton-Euler algorithm.
void inverse_dynamics(const Tree& tree, std::span<const double> q, std::span<const double> v,
                      std::span<const double> qdd, const Vec3& gravity, std::span<NodeWork> work,
                      std::span<double> tau);
/// M(q), velocities x velocities, by the composite rigid body algorithm.
void mass_matrix(const Tree& tree, std::span<const double> q, std::span<NodeWork> work, std::span<double> M);

/// q' = G(q) v.
void position_rate(const Tree& tree, std::span<const double> q, std::span<const double> v,
                   std::span<double> rate);
/// Normalises the quaternions.
void normalise(const Tree& tree, std::span<double> q);

/// A node's frame in the world, after `move`.
spatial::Frame world_frame(const Tree& tree, std::span<const NodeWork> work, int32_t node);
/// The same for all nodes.
void world_frames(const Tree& tree, std::span<const NodeWork> work, std::span<spatial::Frame> out);

}  // namespace truestep::articulation
