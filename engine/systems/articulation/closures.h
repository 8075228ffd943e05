// Loops in a tree: points of two links that coincide, Phi = x_a - x_b = 0. Their forces lambda follow from
//   J M^-1 J^T lambda = -(J q'' at lambda = 0, + J' v) - 2 w Phi' - w^2 Phi          (Baumgarte 1972)
// where every column of J M^-1 J^T is one articulated body solve at rest under a unit force. Remaining errors
// in Phi and Phi' are removed after each step by coordinate projection along M^-1 J^T (Eich 1993). Directions
// in which the links cannot separate anyway (out of the plane of a planar loop) have zero pivots and are left
// out.
#pragma once
#include "engine/systems/articulation/tree.h"

namespace truestep::articulation {

struct Closure {
  int32_t a = kGround, b = kGround;  ///< nodes
  Vec3 at_a, at_b;                   ///< m, in the nodes' frames; the world's for the ground
};

enum class Of : uint8_t { place, velocity, acceleration };
/// World vector of a point of a node: position or velocity after `move`; acceleration after `accelerations`,
/// which leaves out gravity for every node and the ground alike.
Vec3 point(const Tree& tree, std::span<const NodeWork> work, int32_t node, const Vec3& r, Of what,
           const Vec3& gravity);

/// Scratch of all below; grows once.
struct ClosureWork {
  std::vector<double> response;  ///< rows x velocities: change of q'' by unit forces
  std::vector<double> matrix, lambda, residual, change, rate;
  std::vector<uint32_t> order;
  std::vector<Push> outside, pushes;
  Work work;
};

/// Accelerations of a tree with loops under joint forces tau; see `accelerations`.
void closed_accelerations(const Tree& tree, std::span<const Closure> closures, std::span<const double> q,
                          std::span<const double> v, std::span<const double> tau, const Vec3& gravity,
                          std::span<const Push> pushes, std::span<NodeWork> work, ClosureWork& scratch,
                          std::span<double> qdd);
/// Brings q to Phi = 0 and v to Phi' = 0.
void close(const Tree& tree, std::span<const Closure> closures, std::span<double> q, std::span<double> v,
           ClosureWork& scratch);
/// Largest |Phi| (m).
double gap(const Tree& tree, std::span<const Closure> closures, std::span<const double> q, Work& work);

}  // namespace truestep::articulation
