// A prior of natural poses, learnt from a motion: the coordinates x of a pose (the rotation vector of a ball
// joint from its mean rotation, the value of a hinge or slide from its mean) are normally distributed about 0
// with
//   C = U diag(s_k^2) U^T + r^2 (I - U U^T),
// U the principal components of the motion, s_k^2 their variances, r^2 the mean variance of the components
// left out (Tipping, Bishop 1999, "Probabilistic principal component analysis", eqs. 6 to 8). Of all poses
// that satisfy the goals, r(x) = 0, the most natural one has the least x^T C^-1 x (Grochow, Martin,
// Hertzmann, Popovic 2004, "Style-based inverse kinematics", with this Gaussian in place of their latent
// variable model):
//   x <- x + a (x* - x),   x* = C J^T (J C J^T + R)^-1 (r + J x),   J = -dr/dx,  R = spread^2 I,
// with a halved until  |r|^2 / spread^2 + x^T C^-1 x  falls, and a spread that shrinks with the error down to
// the requested one (iterated extended Kalman update, Bell, Cathey 1993).
#pragma once
#include "engine/kernels/animation/inverse_kinematics.h"

namespace truestep::animation {

class PosePrior {
 public:
  PosePrior() = default;
  /// Learns from the poses of `joints` (frames x joints, at least two frames). `known`: per joint, whether
  /// the motion contains it; `components`: the largest number kept; `least`: smallest r, rad or m.
  PosePrior(std::span<const Joint> joints, std::span<const JointMotion> poses, std::span<const uint8_t> known,
            size_t components, double least);

  bool empty() const { return size_ == 0; }
  size_t size() const { return size_; }  ///< coordinates
  size_t components() const { return deviations_.size(); }
  /// Fraction of the motion's variance explained by the components.
  double explained() const { return explained_; }
  /// sqrt(x^T C^-1 x / size): 1 is the motion's own root mean square distance from the mean.
  double distance(std::span<const JointMotion> motion, std::vector<double>& scratch) const;
  /// Sets the mean pose, in the joints contained in the motion.
  void set_mean(std::span<JointMotion> motion) const;

  struct Work {
    std::vector<double> x, target, tried, jacobian, gram, residual, spread, projected;
    std::vector<JointMotion> motion, start, best;
  };
  /// Moves towards the most natural pose that satisfies the goals to within about `spread` (m), orientations
  /// included. Limits hold. If the result is unnatural or misses the goals, the search is repeated from the
  /// mean pose and from 1.5 standard deviations of each of the first two components either way, and the best
  /// result is taken. `ik.poses` holds the poses of the result.
  IkResult solve(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                 double spread, int most, std::span<JointMotion> motion, IkWork& ik, Work& work) const;

 private:
  IkResult descend(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                   double spread, int most, std::span<JointMotion> motion, IkWork& ik, Work& work) const;
  struct Coordinate {
    uint32_t joint = 0;
    size_t first = 0;  ///< in x: three numbers of a ball, one of others
    Quat mean_turn;
    double mean_value = 0;
  };
  void read(std::span<const JointMotion> motion, double* x) const;
  void write(const double* x, std::span<JointMotion> motion) const;
  /// C v, and v^T C^-1 v.
  void spread_out(const double* v, double* out) const;
  double energy(const double* x) const;

  size_t size_ = 0;
  std::vector<JointKind> kinds_;
  std::vector<Coordinate> coordinates_;
  std::vector<double> components_;  ///< per component, `size_` numbers
  std::vector<double> deviations_;
  double rest_ = 1, explained_ = 0;
};

}  // namespace truestep::animation
