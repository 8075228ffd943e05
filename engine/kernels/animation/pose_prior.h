// Which poses are natural, learnt from a motion: coordinates x of a pose (rotation vector of a ball from its
// mean turn, of a hinge or slide its value from the mean) are normally distributed about 0 with
//   C = U diag(s_k^2) U^T + r^2 (I - U U^T),
// U the principal components of the motion, s_k^2 their variances, r^2 the mean of those left out (Tipping,
// Bishop 1999, "Probabilistic principal component analysis", eqs. 6 to 8). Of all poses that bring places to
// where goals want them, r(x) = 0, the most natural one has the least x^T C^-1 x (Grochow, Martin, Hertzmann,
// Popovic 2004, "Style-based inverse kinematics", with this Gaussian for their latent variable model):
//   x <- x + a (x* - x),   x* = C J^T (J C J^T + R)^-1 (r + J x),   J = -dr/dx,  R = spread^2 I,
// a halved until  |r|^2 / spread^2 + x^T C^-1 x  falls, with a spread that shrinks with the error to what is
// asked for (iterated extended Kalman update, Bell, Cathey 1993).
#pragma once
#include "engine/kernels/animation/inverse_kinematics.h"

namespace truestep::animation {

class PosePrior {
 public:
  PosePrior() = default;
  /// From poses of `joints` (frames x joints); `known`: per joint, whether the motion says anything about it.
  /// `components`: at most so many; `least`: rad or m, smallest r. At least two frames.
  PosePrior(std::span<const Joint> joints, std::span<const JointMotion> poses, std::span<const uint8_t> known,
            size_t components, double least);

  bool empty() const { return size_ == 0; }
  size_t size() const { return size_; }  ///< coordinates
  size_t components() const { return deviations_.size(); }
  /// Share of the motion's variance that the components hold.
  double explained() const { return explained_; }
  /// sqrt(x^T C^-1 x / size): 1 is as far from the mean as the motion itself is on average.
  double distance(std::span<const JointMotion> motion, std::vector<double>& scratch) const;
  /// The mean pose, in joints that the motion says something about.
  void set_mean(std::span<JointMotion> motion) const;

  struct Work {
    std::vector<double> x, target, tried, jacobian, gram, residual, spread, projected;
    std::vector<JointMotion> motion, start, best;
  };
  /// Towards the most natural pose whose places are at the goals to within `spread` (m) or so; orientations
  /// count. Limits hold. Where it ends in a pose that is not natural or not at the goals, it begins again
  /// from the mean pose and from those a deviation of the first two components off it, and the best is taken.
  /// Poses of the result are in `ik.poses`.
  IkResult solve(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                 double spread, int most, std::span<JointMotion> motion, IkWork& ik, Work& work) const;

 private:
  IkResult descend(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                   double spread, int most, std::span<JointMotion> motion, IkWork& ik, Work& work) const;
  struct Coordinate {
    uint32_t joint = 0;
    size_t first = 0;  ///< in x: three of a ball, one of others
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
  std::vector<double> components_;  ///< per component, size_ numbers
  std::vector<double> deviations_;
  double rest_ = 1, explained_ = 0;
};

}  // namespace truestep::animation
