// Newton's linear systems of a tree of links in O(n), by the articulated body algorithm of the linearised
// motion. With the changes, in a node's own coordinates, of its velocity nu, its acceleration alpha and its
// pose xi, and with the joint's velocity v_j,
//   xi    = X xi' + S dp
//   nu    = X nu' + (X v' x S) dp + S dv
//   alpha = X alpha' + (X a' x S) dp + (v x S) dv + S da - S v_j x nu        (' : of the parent)
// the wrench through its joint changes by dF = P (nu, alpha, xi) + p, where P and p sum up the subtree; a
// change dp of the joint turns F as well. A method's equations make dp, dv and da functions of one unknown d,
//   dp = Ax d + cx,  dv = Av d + cv,  da = d + ca,
// and S^T dF + K dp + C dv = 0, with the joint's own stiffness K and damping C, gives d; what remains of P
// goes to the parent. Poses matter only for forces with a fixed direction in the world. Source: Featherstone,
// Rigid Body Dynamics Algorithms (2008), table 7.1, differentiated.
#pragma once
#include <vector>

#include "engine/math/complex.h"
#include "engine/systems/articulation/tree.h"

namespace truestep::articulation {

/// The response of a joint's drive to small changes: effort = -stiffness dp - damping dv.
struct DriveSlope {
  double stiffness[3][3] = {};  ///< rows and columns in the order of the joint's velocities
  double damping = 0;
};

/// nu and alpha, of six numbers each, then xi.
inline constexpr size_t kMotions = 12, kMotionsAndPose = 18;

/// A node's part of the linearised motion.
struct NodeSlope {
  spatial::Frame frame;
  Move move = Move::fixed;
  int32_t parent = kGround;
  uint32_t q = 0, v = 0;
  double S[6][3];
  double with_p[kMotionsAndPose][3], with_v[kMotionsAndPose][3];  ///< of (nu, alpha, xi), without S v_j x nu
  double turned[6][3];                                            ///< of the wrench on the parent, per dp
  double own[6][kMotionsAndPose];                                 ///< P of the node alone
  spatial::Motion joint;                                          ///< S v_j
  double orientation[4], spin[3];                                 ///< for balls: quaternion, angular velocity
  DriveSlope drive;
};

/// The tree linearised at a point with known accelerations.
class LinearTree {
 public:
  /// `work` and `qdd` as `accelerations` leaves them at (q, v) under `pushes`; one drive per node.
  void linearise(const Tree& tree, std::span<const double> q, std::span<const double> v,
                 std::span<const double> qdd, std::span<const NodeWork> work, std::span<const Push> pushes,
                 std::span<const DriveSlope> drives);
  const std::vector<NodeSlope>& nodes() const { return nodes_; }
  /// kMotions, or kMotionsAndPose with poses.
  size_t width() const { return width_; }

 private:
  std::vector<NodeSlope> nodes_;
  std::vector<spatial::Frame> frames_;  // of the nodes in the world
  size_t width_ = kMotions;
};

/// One factorisation, T real or complex.
template <class T>
class TreeFactors {
 public:
  /// Factorises I - z J; false: singular or not finite.
  bool factor(const LinearTree& tree, T z) { return factor(tree, z * z, z, 0.5 * z); }
  /// Factorises I - with_v da/dv - with_x da/dx, for trees without balls.
  bool factor_second_order(const LinearTree& tree, T with_x, T with_v) {
    return factor(tree, with_x, with_v, T(0));
  }
  /// (I - z J)^-1 (x, v) in place.
  void solve(const LinearTree& tree, T* x, T* v);
  /// (I - with_v da/dv - with_x da/dx)^-1 b in place.
  void solve_second_order(const LinearTree& tree, T* b);

 private:
  struct Node {
    T P[6][kMotionsAndPose];
    T W[kMotionsAndPose][3];  // of (nu, alpha, xi), per d
    T G[3][kMotionsAndPose];  // D^-1 S^T P
    T left[6][3];             // of the parent's wrench, per d
    T Ax[3][3], Dinv[3][3];
    T p[6], y[3];
    T change[kMotionsAndPose];  // (nu, alpha, xi)
  };
  bool factor(const LinearTree& tree, T with_x, T with_v, T half_z);
  bool eliminate(const NodeSlope& n, Node& f, T with_x, size_t width);
  void sweep(const LinearTree& tree);

  T with_v_ = T(0), half_z_ = T(0);
  std::vector<Node> nodes_;
  std::vector<T> cx_, cv_, ca_, d_;  // per velocity
};

extern template class TreeFactors<double>;
extern template class TreeFactors<Complex>;

}  // namespace truestep::articulation
