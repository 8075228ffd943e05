// The distribution that a prior learns, and that with it natural poses win among the many that reach a goal.
#include "engine/kernels/animation/pose_prior.h"

#include <cmath>

#include "tests/unit/animation_rig.h"

namespace truestep::animation {
namespace {

/// A chain of six balls whose natural poses are made of two numbers a and b: ball j is turned by a u_j + b
/// v_j.
struct Family {
  testing_rig::Chain chain{6, 0.3};
  std::vector<Vec3> u, v;
  std::mt19937 engine{7};

  Family() {
    std::uniform_real_distribution<double> d(-1, 1);
    for (int j = 0; j < 6; ++j) {
      u.push_back({d(engine), d(engine), d(engine)});
      v.push_back({d(engine), d(engine), d(engine)});
    }
  }
  std::vector<JointMotion> pose(double noise) {
    std::normal_distribution<double> g(0, 0.4), n(0, noise);
    const double a = g(engine), b = g(engine);
    std::vector<JointMotion> out(6);
    for (size_t j = 0; j < 6; ++j) {
      const Vec3 off = noise > 0 ? Vec3{n(engine), n(engine), n(engine)} : Vec3{};
      out[j].turn = free_rotation::turn(u[j] * a + v[j] * b + off);
    }
    return out;
  }
  PosePrior learn(double noise, size_t components = 2) {
    std::vector<JointMotion> all;
    for (int k = 0; k < 300; ++k) {
      const auto p = pose(noise);
      all.insert(all.end(), p.begin(), p.end());
    }
    const std::vector<uint8_t> known(6, 1);
    return PosePrior(chain.joints, all, known, components, 1e-3);
  }
  Vec3 end_of(const std::vector<JointMotion>& pose) {
    chain.motion = pose;
    return chain.place();
  }
};

/// rad, root of the mean square angle between the turns of two poses.
double apart(std::span<const JointMotion> a, std::span<const JointMotion> b) {
  double sum = 0;
  for (size_t j = 0; j < a.size(); ++j)
    sum += norm2(free_rotation::rotation_vector(conjugate(a[j].turn) * b[j].turn));
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(PosePrior, FindsHowManyNumbersPosesAreMadeOf) {
  Family f;
  const PosePrior prior = f.learn(0);
  EXPECT_EQ(prior.size(), 18u);
  EXPECT_EQ(prior.components(), 2u);
  // Two numbers make all poses; rotation vectors from the mean turn bend the plane that they lie in by terms
  // of second order (0.4 rad squared, over the twelve of Baker, Campbell and Hausdorff: 1 %).
  EXPECT_GT(prior.explained(), 0.98);
  // The control: one number does not do.
  EXPECT_LT(f.learn(0, 1).explained(), 0.95);
}

TEST(PosePrior, DistanceCountsDeviations) {
  Family f;
  const PosePrior prior = f.learn(0.02, 2);
  std::vector<double> scratch;
  double sum = 0;
  constexpr int kPoses = 400;
  for (int k = 0; k < kPoses; ++k) {
    const double d = prior.distance(f.pose(0.02), scratch);
    sum += d * d;
  }
  // The mean of x^T C^-1 x is the number of coordinates; 400 poses of 18 coordinates, and 300 that were
  // learnt from, tell it to sqrt(2 (1/400 + 1/300) / 18) = 3 %, tails of the bent plane to 10 %.
  EXPECT_NEAR(sum / kPoses, 1, 0.2);
  std::vector<JointMotion> mean(6);
  prior.set_mean(mean);
  EXPECT_NEAR(prior.distance(mean, scratch), 0, 1e-9);
  std::vector<JointMotion> odd = mean;
  odd[3].turn = normalized(odd[3].turn * turn_about({0, 0, 1}, 1));
  EXPECT_GT(prior.distance(odd, scratch), 5) << "the control: one joint turned out of all habit";
}

TEST(PosePrior, NaturalPosesWinAmongManySolutions) {
  Family f;
  const PosePrior prior = f.learn(0.01);
  double with = 0, without = 0, farthest = 0;
  constexpr int kTargets = 40;
  IkWork ik;
  PosePrior::Work work;
  std::vector<double> scratch;
  double odd = 0, natural = 0;
  for (int k = 0; k < kTargets; ++k) {
    // Poses that were not learnt from; their ends are all that is told.
    const std::vector<JointMotion> truth = f.pose(0.01);
    const IkGoal goal = f.chain.goal(f.end_of(truth));
    std::vector<JointMotion> found(6), plain(6);
    prior.set_mean(plain);
    prior.set_mean(found);
    prior.solve(f.chain.joints, {}, std::span(&goal, 1), 1e-3, 100, found, ik, work);
    const IkResult r = solve_ik(f.chain.joints, {}, std::span(&goal, 1), {.tolerance = 1e-6}, found, ik);
    farthest = std::max(farthest, r.error);
    solve_ik(f.chain.joints, {}, std::span(&goal, 1), {.tolerance = 1e-6, .most = 500}, plain, ik);
    with += apart(truth, found), without += apart(truth, plain);
    natural = std::max(natural, prior.distance(found, scratch)),
    odd += prior.distance(plain, scratch) / kTargets;
  }
  std::printf(
      "pose error: with %.4f without %.4f rad; distance: with at most %.2f, without "
      "%.2f\n",
      with / kTargets, without / kTargets, natural, odd);
  EXPECT_LT(farthest, 1e-6) << "the goal is reached as exactly as without";
  // Three coordinates of the end tell the two numbers that the pose is made of: what is left is the noise of
  // 0.01 rad in each of 18 coordinates (0.017 rad a joint), magnified where the end hardly moves with a
  // number. Without a prior the end says three of eighteen coordinates.
  EXPECT_LT(with, 0.3 * without);
  // As natural as what was learnt from: poses of two coordinates are beyond three deviations once in ninety.
  EXPECT_LT(natural, 3);
  EXPECT_GT(odd, 3) << "the control: the nearest solution is none of the family";
}

TEST(PosePrior, AWeightOfNothingIsTheMean) {
  // Goals of which nothing is asked leave the most natural pose, the mean.
  Family f;
  const PosePrior prior = f.learn(0.01);
  std::vector<JointMotion> motion = f.pose(0.2), mean(6);
  prior.set_mean(mean);
  IkGoal goal = f.chain.goal(f.end_of(mean));
  IkWork ik;
  PosePrior::Work work;
  prior.solve(f.chain.joints, {}, std::span(&goal, 1), 1e-4, 200, motion, ik, work);
  // Settled to 1e-7 in an iteration that converges linearly.
  EXPECT_LT(apart(mean, motion), 1e-5);
}

TEST(PosePrior, HoldsLimits) {
  Family f;
  const PosePrior prior = f.learn(0.01);
  for (Joint& j : f.chain.joints) j.cone = 0.3;
  const IkGoal goal = f.chain.goal({0.4, 0.9, 0.3});
  std::vector<JointMotion> motion(6);
  IkWork ik;
  PosePrior::Work work;
  prior.solve(f.chain.joints, {}, std::span(&goal, 1), 1e-3, 100, motion, ik, work);
  for (size_t j = 0; j < 6; ++j) {
    const auto [swing, twist] = swing_twist(motion[j].turn, f.chain.joints[j].axis);
    EXPECT_LE(norm(free_rotation::rotation_vector(swing)), 0.3 + 1e-9) << j;
  }
}

}  // namespace
}  // namespace truestep::animation
