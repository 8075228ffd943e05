// Inverse kinematics: every solver against closed forms and against the others; limits, priorities, poles,
// orientations; unreachable targets.
#include "tests/unit/animation/animation_rig.h"

namespace truestep::animation {
namespace {

using testing_rig::Chain;

constexpr IkMethod kIterative[] = {IkMethod::gradient, IkMethod::gauss_newton, IkMethod::damped_least_squares,
                                   IkMethod::ccd, IkMethod::fabrik};

TEST(InverseKinematics, TwoLinksHaveTheReferencesAngles) {
  // anim.ik2
  const TwoLinkAngles a = two_link_angles(1, 0.8, 1.2, 0.5);
  EXPECT_NEAR(a.first[0], -0.26770145659923895001, 1e-12);
  EXPECT_NEAR(a.second[0], 1.5395412382954014645, 1e-12);
  EXPECT_NEAR(a.first[1], 1.0572836959987619835, 1e-12);
  EXPECT_NEAR(a.second[1], -1.5395412382954014645, 1e-12);
  EXPECT_EQ(a.miss, 0);
  // At exact reach both solutions coincide; beyond it and within the hole, the miss is reported.
  const TwoLinkAngles straight = two_link_angles(1, 0.8, 1.8, 0);
  EXPECT_NEAR(straight.second[0] - straight.second[1], 0, 1e-7);
  EXPECT_NEAR(two_link_angles(1, 0.8, 3, 4).miss, 3.2, 1e-15);
  EXPECT_NEAR(two_link_angles(1, 0.8, 0.1, 0).miss, 0.1, 1e-15);
  EXPECT_NEAR(two_link_angles(1, 0.8, 3, 4).first[0], std::atan2(4, 3), 1e-15);
  using enum TwoLinkAngles::Reach;
  EXPECT_EQ(a.reach, both);
  EXPECT_EQ(straight.reach, one) << "singular";
  EXPECT_EQ(two_link_angles(1, 0.8, 0, -0.2).reach, one) << "folded";
  EXPECT_EQ(two_link_angles(1, 0.8, 3, 4).reach, too_far);
  EXPECT_EQ(two_link_angles(1, 0.8, 0.1, 0).reach, too_near);
}

TEST(InverseKinematics, TheTreesTwoLinksAreThose) {
  for (const double elbow : {1.0, -1.0}) {
    Chain chain(2, 1, JointKind::revolute);
    chain.end = {0.8, 0, 0};
    const IkResult r = chain.solve(chain.goal({1.2, 0.5, 0}),
                                   {.method = IkMethod::two_link, .tolerance = 1e-12, .elbow = elbow});
    EXPECT_EQ(r.end, IkResult::End::reached);
    EXPECT_NEAR(chain.motion[0].value, elbow > 0 ? -0.26770145659923895001 : 1.0572836959987619835, 1e-12);
    EXPECT_NEAR(chain.motion[1].value, elbow * 1.5395412382954014645, 1e-12);
  }
  // In space with a pole: the middle is on the pole's side of the line.
  Chain chain(2, 1);
  IkGoal g = chain.goal({0.5, 0.9, -0.7});
  g.pole = Vec3{0, 0, 5};
  EXPECT_LT(chain.solve(g, {.method = IkMethod::two_link}).error, 1e-14);
  const Vec3 u = normalized(g.target), middle = chain.work.poses[1].position;
  const Vec3 across = middle - u * dot(u, middle), side = *g.pole - u * dot(u, *g.pole);
  EXPECT_GT(dot(normalized(across), normalized(side)), 1 - 1e-12);
}

TEST(InverseKinematics, APoleTurnsWhatEverySolverFinds) {
  for (const IkMethod method : kIterative) {
    for (const Vec3& pole : {Vec3{0, 0, 5}, Vec3{-4, 1, -3}}) {
      Chain chain(3, 0.5);
      std::mt19937 engine(9);
      chain.shake(engine, 0.5);
      IkGoal g = chain.goal({0.5, 0.7, -0.4});
      g.pole = pole;
      // Rotating about the line to the target leaves the end in place.
      EXPECT_LT(chain.solve(g, {.method = method, .tolerance = 1e-6, .most = 500}).error, 1e-5);
      const Vec3 u = normalized(g.target), side = normalized(pole - u * dot(u, pole));
      Vec3 bend;
      for (size_t j = 1; j < 3; ++j) {
        const Vec3 off = chain.work.poses[j].position, across = off - u * dot(u, off);
        if (norm2(across) > norm2(bend)) bend = across;
      }
      // The joint farthest from the line is on the pole's side, to the millionths of the end.
      EXPECT_GT(dot(normalized(bend), side), 1 - 1e-6) << static_cast<int>(method);
    }
  }
}

TEST(InverseKinematics, AllSolversReachWhatCanBeReached) {
  std::mt19937 engine(17);
  for (const IkMethod method : kIterative) {
    for (const size_t n : {3, 10, 30}) {
      Chain chain(n, 1 / static_cast<double>(n));
      for (int k = 0; k < 10; ++k) {
        // A point reached by the end of another pose of the same chain.
        Chain other = chain;
        other.shake(engine, 1.5);
        const Vec3 target = other.place();
        chain.motion.assign(n, {});
        const IkResult r =
            chain.solve(chain.goal(target), {.method = method, .tolerance = 1e-4, .most = 5000});
        EXPECT_EQ(r.end, IkResult::End::reached) << static_cast<int>(method) << ' ' << n << ' ' << k;
        // The reported error is that of the end.
        EXPECT_NEAR(r.error, norm(chain.place() - target), 1e-12);
        for (size_t j = 1; j < n; ++j) {
          EXPECT_NEAR(norm(chain.work.poses[j].position - chain.work.poses[j - 1].position),
                      1 / static_cast<double>(n), 1e-14);
        }
      }
    }
  }
}

TEST(InverseKinematics, WhatIsTooFarIsPointedAt) {
  for (const IkMethod method : kIterative) {
    Chain chain(5, 0.2);
    std::mt19937 engine(3);
    chain.shake(engine, 0.5);
    const IkResult r =
        chain.solve(chain.goal({1, 1, 1}), {.method = method, .tolerance = 1e-6, .most = 20000});
    EXPECT_NE(r.end, IkResult::End::reached);
    // The nearest point that an arm of 1 m can reach. FABRIK has it in closed form, damped steps stop at the
    // last digits of E; the others creep there and stop when an iteration gains too little.
    const bool creeps = method != IkMethod::damped_least_squares;
    const double tolerance = method == IkMethod::fabrik ? 1e-12 : creeps ? 5e-3 : 1e-4;
    EXPECT_NEAR(r.error, std::sqrt(3.0) - 1, tolerance) << static_cast<int>(method);
  }
}

TEST(InverseKinematics, AStraightArmFolds) {
  // Singular: no freedom moves the end along the line to the target.
  for (const IkMethod method : kIterative) {
    Chain chain(4, 0.25);
    const IkResult r =
        chain.solve(chain.goal({0.4, 0, 0}), {.method = method, .tolerance = 1e-4, .most = 3000});
    EXPECT_EQ(r.end, IkResult::End::reached) << static_cast<int>(method);
  }
}

TEST(InverseKinematics, LimitsHold) {
  std::mt19937 engine(23);
  for (const IkMethod method : kIterative) {
    for (const JointKind kind : {JointKind::ball, JointKind::revolute}) {
      if (kind == JointKind::revolute && method == IkMethod::fabrik) continue;
      Chain chain(6, 0.2, kind);
      for (Joint& j : chain.joints) {
        j.min = -0.6, j.max = 0.6, j.cone = 0.6;
        if (kind == JointKind::ball) j.axis = {1, 0, 0};
      }
      int reached = 0;
      for (int k = 0; k < 10; ++k) {
        Chain other = chain;
        other.shake(engine, 0.4);
        chain.motion.assign(6, {});
        reached += chain.solve(chain.goal(other.place()), {.method = method, .most = 3000}).error < 1e-4;
        for (size_t j = 0; j < 6; ++j) EXPECT_FALSE(JointMotion(chain.motion[j]).value > 0.6 + 1e-12);
        for (size_t j = 0; j < 6; ++j) {
          const auto [swing, twist] = swing_twist(chain.motion[j].turn, chain.joints[j].axis);
          EXPECT_LE(norm(free_rotation::rotation_vector(swing)), 0.6 + 1e-9);
          EXPECT_LE(std::abs(twist), 0.6 + 1e-9);
        }
      }
      // A solution exists; local methods may miss it at a limit, FABRIK most often.
      EXPECT_GE(reached, method == IkMethod::fabrik ? 5 : 9)
          << static_cast<int>(method) << static_cast<int>(kind);
    }
  }
}

TEST(InverseKinematics, AnOrientationIsReachedWithAPlace) {
  for (const IkMethod method : {IkMethod::gradient, IkMethod::gauss_newton, IkMethod::damped_least_squares}) {
    std::mt19937 engine(29);
    Chain chain(6, 0.2), other(6, 0.2);
    other.shake(engine, 0.6);
    IkGoal g = chain.goal(other.place());
    g.orientation = other.work.poses.back().orientation, g.orientation_weight = 0.3;
    const IkResult r = chain.solve(g, {.method = method, .tolerance = 1e-5, .most = 20000});
    EXPECT_EQ(r.end, IkResult::End::reached) << static_cast<int>(method);
    const Quat off = conjugate(*g.orientation) * chain.work.poses.back().orientation;
    EXPECT_LT(norm(free_rotation::rotation_vector(off)), 1e-4);
  }
}

TEST(InverseKinematics, PrioritiesGoFirst) {
  // Contradictory goals: the end of a chain and its middle are wanted far apart.
  for (const IkMethod method : {IkMethod::gauss_newton, IkMethod::damped_least_squares}) {
    Chain chain(6, 0.2);
    IkGoal goals[2] = {chain.goal({0.6, 0.6, 0}), chain.goal({0, -0.7, 0})};
    goals[1].joint = 3, goals[1].point = {}, goals[1].priority = 1;
    std::vector<JointMotion> motion(6);
    IkWork work;
    const auto error = [&](int k) {
      return norm(goals[k].target - work.poses[goals[k].joint].position -
                  rotate(work.poses[goals[k].joint].orientation, goals[k].point));
    };
    const IkOptions options{.method = method, .tolerance = 1e-5, .most = 300};
    solve_ik(chain.joints, {}, goals, options, motion, work);
    EXPECT_LT(error(0), 1e-3);
    EXPECT_GT(error(1), 0.1);
    // The control: without priorities both goals compromise.
    goals[1].priority = 0;
    motion.assign(6, {});
    solve_ik(chain.joints, {}, goals, options, motion, work);
    EXPECT_GT(error(0), 0.05);
  }
}

TEST(InverseKinematics, SeveralGoalsOnATree) {
  // A trunk of two bones with two arms of three.
  std::vector<Joint> joints(8);
  const int32_t parents[] = {-1, 0, 1, 2, 3, 1, 5, 6};
  for (size_t j = 0; j < 8; ++j) {
    joints[j].parent = parents[j];
    if (j > 0) joints[j].rest.position = {0, 0.3, 0};
    if (j == 2) joints[j].rest.position = {0.15, 0.25, 0};
    if (j == 5) joints[j].rest.position = {-0.15, 0.25, 0};
  }
  for (const IkMethod method : kIterative) {
    std::vector<JointMotion> motion(8);
    IkWork work;
    IkGoal goals[2];
    goals[0].joint = 4, goals[0].point = {0, 0.2, 0}, goals[0].target = {0.6, 0.7, 0.2};
    goals[1].joint = 7, goals[1].point = {0, 0.2, 0}, goals[1].target = {-0.5, 0.9, -0.1};
    const IkResult r =
        solve_ik(joints, {}, goals, {.method = method, .tolerance = 1e-4, .most = 5000}, motion, work);
    EXPECT_LT(r.error, 1e-4) << static_cast<int>(method);
  }
}

TEST(InverseKinematics, NothingIsLostOnStrangeInput) {
  for (const IkMethod method : kIterative) {
    for (const Vec3 target : {Vec3{}, Vec3{1e12, 0, 0}, Vec3{1e-300, 0, 0}, Vec3{0.2, 0, 0}}) {
      Chain chain(3, 0.2);
      chain.solve(chain.goal(target), {.method = method, .most = 50});
      for (const JointMotion& m : chain.motion)
        EXPECT_TRUE(std::isfinite(m.turn.w) && std::isfinite(m.turn.x));
    }
    Chain point(1, 0);  // no length at all
    point.solve(point.goal({1, 2, 3}), {.method = method, .most = 50});
    EXPECT_TRUE(std::isfinite(point.motion[0].turn.w));
  }
}

}  // namespace
}  // namespace truestep::animation
