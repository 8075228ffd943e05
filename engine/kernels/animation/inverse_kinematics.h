// Inverse kinematics: joint coordinates that bring points of a joint tree to their targets. The residual is
//   r = (w (target - point), w_o rotation_vector(wanted orientation*))  of every goal,   E = 1/2 |r|^2,
// and J its derivative with respect to the freedoms (joint_tree.h). Solvers:
//   gradient              q += a J^T r, a by Armijo's rule from Buss's first guess (Buss 2004, eq. 8)
//   gauss_newton          q += J^+ r of least norm, halved until E falls
//   damped_least_squares  q += J^T (J J^T + l I)^-1 r, l by the ratio of actual to predicted gain (Nielsen
//                         1999)
//   ccd                   joint by joint from the end to the base, each rotated as far as it helps (Wang,
//                         Chen 1991)
//   fabrik                positions by forward and backward reaching (Aristidou, Lasenby 2011), then the
//                         rotations that lead to them; if a joint is not an unlimited ball, rotations and
//                         limits in every iteration; a single unlimited chain with Aitken's relaxation of
//                         the target
//   two_link              the two closed-form solutions for a base, a middle and an end
// Goals of priority k > 0 use only the null space of the Jacobians of the goals before them (Siciliano,
// Slotine 1991); gauss_newton and damped_least_squares only. Limits hold after every iteration; least squares
// leave blocked freedoms out. A pole turns the chain about the line from base to end until its middle is on
// the pole's side; the base must be a ball.
#pragma once
#include <optional>

#include "engine/kernels/animation/joint_tree.h"

namespace truestep::animation {

enum class IkMethod : uint8_t { gradient, gauss_newton, damped_least_squares, ccd, fabrik, two_link };

struct IkGoal {
  uint32_t joint = 0;
  uint32_t base = 0;  ///< first joint that may move on the chain from the root
  Vec3 point;         ///< m, in the joint's frame
  Vec3 target;        ///< m, in the world
  double weight = 1;
  std::optional<Quat> orientation;  ///< wanted orientation of the joint's frame, in the world
  double orientation_weight = 1;    ///< m/rad
  int priority = 0;
  std::optional<Vec3> pole;  ///< m, in the world
};

struct IkOptions {
  IkMethod method = IkMethod::damped_least_squares;
  double tolerance = 1e-4;  ///< m, accepted for the largest distance to a target
  int most = 100;           ///< iterations
  double elbow = 1;         ///< two_link without a pole: 1 or -1, the side to which the arm bends
};

struct IkResult {
  double error = 0;  ///< m, largest distance to a target, or largest weighted angle to an orientation
  int iterations = 0;
  enum class End : uint8_t { reached, stalled, exhausted } end = End::reached;
};

/// Scratch memory, reused from call to call.
struct IkWork {
  std::vector<Pose> poses, tried_poses;
  std::vector<JointMotion> tried;
  static constexpr uint32_t kNone = ~0u;
  std::vector<uint8_t> moves;                     ///< per joint
  std::vector<uint32_t> first_child, next_child;  ///< among the joints that move
  std::vector<uint32_t> joint_of, freedom_of;     ///< per column
  std::vector<double> jacobian, gram, residual, step, projected, basis;
  std::vector<uint8_t> frozen;
  std::vector<Vec3> places, proposals;
  std::vector<uint32_t> counts, path;
  std::vector<double> lengths;
  std::vector<uint32_t> row;     ///< of a single chain, base first
  std::vector<Vec3> row_places;  ///< in its order
  std::vector<double> row_lengths;
  std::vector<IkGoal> sorted;
};

/// Moves `motion` towards the goals; forward kinematics of the result are in work.poses.
IkResult solve_ik(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                  const IkOptions& options, std::span<JointMotion> motion, IkWork& work);

/// Derivatives of the goals' residuals (with the sign of the points' velocities), rows x columns, the columns
/// as in work.joint_of and work.freedom_of; work.poses must be current.
void ik_jacobian(std::span<const Joint> joints, std::span<const IkGoal> goals, IkWork& work);
/// Fills work.moves and the columns for these goals.
void ik_columns(std::span<const Joint> joints, std::span<const IkGoal> goals, IkWork& work);
/// Number of rows of a goal: 3, or 6 with an orientation.
constexpr size_t ik_rows(const IkGoal& g) {
  return g.orientation ? 6 : 3;
}

/// Both solutions for an arm of two links from the origin in the plane: the angle of the first link from x
/// and that of the second from the first. Out of reach the arm points at the target (or folds), and `miss` is
/// the distance left; at exact reach the two solutions coincide.
struct TwoLinkAngles {
  double first[2], second[2];  ///< rad; [0] has the positive second angle
  double miss = 0;             ///< m
  /// Number of solutions: one, singular, where the arm is stretched or folded (within a millionth of a
  /// radian); none where the target is too far or too near.
  enum class Reach : uint8_t { both, one, too_far, too_near } reach = Reach::both;
};
TwoLinkAngles two_link_angles(double l1, double l2, double x, double y);

namespace ik {  // parts of solve_ik that its files share

/// Largest distance to a target, m.
double error_of(std::span<const IkGoal> goals, std::span<const Pose> poses);
IkResult least_squares(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                       const IkOptions& options, std::span<JointMotion> motion, IkWork& work);
IkResult ccd(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
             const IkOptions& options, std::span<JointMotion> motion, IkWork& work);
IkResult fabrik(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                const IkOptions& options, std::span<JointMotion> motion, IkWork& work);
IkResult two_link(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                  const IkOptions& options, std::span<JointMotion> motion, IkWork& work);
/// Rotates every moving joint, parents first and within the limits, so that the next points of its chains lie
/// where work.places says; updates the poses.
void turn_to_places(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                    std::span<JointMotion> motion, IkWork& work);
/// Applies the goals' poles.
void turn_to_pole(std::span<const Joint> joints, const Pose& root, std::span<const IkGoal> goals,
                  std::span<JointMotion> motion, IkWork& work);

}  // namespace ik

}  // namespace truestep::animation
