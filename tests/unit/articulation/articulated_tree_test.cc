// Three algorithms that share little besides the kinematics agree on random trees: articulated body (q''),
// recursive Newton-Euler (tau) and composite rigid body (M).
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "engine/systems/articulation/tree.h"
#include "tests/unit/articulation/random_tree.h"

namespace truestep::articulation {
namespace {

struct Start {
  std::vector<double> q, v, tau;
};
Start random_start(Draw& draw, const Tree& t) {
  Start s{std::vector<double>(t.positions), std::vector<double>(t.velocities),
          std::vector<double>(t.velocities)};
  for (double& x : s.q) x = 2 * draw();
  for (double& x : s.v) x = 2 * draw();
  for (double& x : s.tau) x = 5 * draw();
  normalise(t, s.q);
  return s;
}

const Vec3 kGravity{1, -9.81, 2};

TEST(ArticulatedTree, AccelerationsSolveTheEquationsOfMotion) {
  int wrong = 0;
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    Draw draw{seed};
    const Tree t = random_tree(draw, 1 + int(seed % 12));
    const Start s = random_start(draw, t);
    const auto n = static_cast<Eigen::Index>(t.velocities);
    std::vector<NodeWork> work(t.nodes.size());
    std::vector<double> qdd(t.velocities), h(t.velocities), tau(t.velocities), zero(t.velocities);
    std::vector<double> m(t.velocities * t.velocities);
    accelerations(t, s.q, s.v, s.tau, kGravity, {}, work, qdd);
    inverse_dynamics(t, s.q, s.v, zero, kGravity, work, h);
    inverse_dynamics(t, s.q, s.v, qdd, kGravity, work, tau);
    mass_matrix(t, s.q, work, m);
    const Eigen::Map<const Eigen::MatrixXd> M(m.data(), n, n);
    const auto map = [&](const std::vector<double>& x) {
      return Eigen::Map<const Eigen::VectorXd>(x.data(), n);
    };
    if (n == 0) continue;
    const Eigen::VectorXd residual = M * map(qdd) + map(h) - map(s.tau);
    // Rounding in the largest term of each equation.
    const double scale = 1 + (M.cwiseAbs() * map(qdd).cwiseAbs()).maxCoeff() + map(h).cwiseAbs().maxCoeff();
    EXPECT_LT(residual.cwiseAbs().maxCoeff(), 1e-12 * scale) << seed;
    EXPECT_LT((map(tau) - map(s.tau)).cwiseAbs().maxCoeff(), 1e-12 * scale) << seed;
    EXPECT_GT(M.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0) << seed;
    // The control: without the velocity-dependent terms the same equations do not hold.
    std::vector<double> still(t.velocities);
    inverse_dynamics(t, s.q, zero, zero, kGravity, work, still);
    wrong += (M * map(qdd) + map(still) - map(s.tau)).cwiseAbs().maxCoeff() > 1e-6 * scale;
  }
  // Some trees have none: single translations, for example.
  EXPECT_GT(wrong, 35);
}

TEST(ArticulatedTree, TheMassMatrixGivesTheKineticEnergy) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Draw draw{seed};
    const Tree t = random_tree(draw, 9);
    const Start s = random_start(draw, t);
    std::vector<NodeWork> work(t.nodes.size());
    std::vector<double> m(t.velocities * t.velocities);
    mass_matrix(t, s.q, work, m);
    move(t, s.q, s.v, work);
    double kinetic = 0, quadratic = 0;
    for (size_t i = 0; i < t.nodes.size(); ++i) {
      kinetic += 0.5 * spatial::dot(work[i].v, t.nodes[i].inertia * work[i].v);
    }
    for (size_t i = 0; i < s.v.size(); ++i) {
      for (size_t j = 0; j < s.v.size(); ++j) quadratic += 0.5 * s.v[i] * m[i * s.v.size() + j] * s.v[j];
    }
    EXPECT_NEAR(quadratic, kinetic, 1e-12 * kinetic) << seed;
  }
}

TEST(ArticulatedTree, APushWorksLikeTheJointForcesThatItGives) {
  // Power of the push = power of tau for every velocity: by the principle of virtual work the push equals the
  // joint forces J^T f, whose accelerations it must produce.
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Draw draw{seed};
    const Tree t = random_tree(draw, 8);
    Start s = random_start(draw, t);
    const Push push{7, draw.vector(), draw.vector()};
    std::vector<NodeWork> work(t.nodes.size());
    std::vector<double> pushed(t.velocities), driven(t.velocities), equal = s.tau, unit(t.velocities);
    for (size_t k = 0; k < unit.size(); ++k) {
      std::fill(unit.begin(), unit.end(), 0.0);
      unit[k] = 1;
      move(t, s.q, unit, work);
      const Vec3 v = work[7].v.v + cross(work[7].v.w, push.at);
      equal[k] += dot(world_frame(t, work, 7).R.apply(v), push.force);
    }
    accelerations(t, s.q, s.v, s.tau, kGravity, {&push, 1}, work, pushed);
    accelerations(t, s.q, s.v, equal, kGravity, {}, work, driven);
    for (size_t k = 0; k < unit.size(); ++k)
      EXPECT_NEAR(pushed[k], driven[k], 1e-10 * (1 + std::abs(driven[k])));
  }
}

TEST(ArticulatedTree, JointsOfAChainAtRestCarryWhatHangsFromThem) {
  Tree t;
  for (int i = 0; i < 4; ++i) {
    Node n;
    n.move = Move::revolute, n.parent = i - 1, n.frame.p = {0, i == 0 ? 0.0 : -1.0, 0};
    n.inertia = {2, {0, -2, 0}, {2, 0, 2, 0, 0, 0}};
    t.add(n);
  }
  std::vector<double> zero(4), qdd(4);
  std::vector<NodeWork> work(4);
  accelerations(t, zero, zero, zero, {0, -10, 0}, {}, work, qdd);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(qdd[i], 0, 1e-14);
    EXPECT_NEAR(joint_force(work[i]).f.y, 20.0 * double(4 - i), 1e-12);
  }
}

TEST(ArticulatedTree, TheRateOfAQuaternionKeepsItsLength) {
  Draw draw{5};
  Tree t;
  Node n;
  n.move = Move::spherical;
  t.add(n);
  const Start s = random_start(draw, t);
  double rate[4], along = 0;
  position_rate(t, s.q, s.v, rate);
  for (int k = 0; k < 4; ++k) along += rate[k] * s.q[size_t(k)];
  EXPECT_NEAR(along, 0, 1e-15);
}

}  // namespace
}  // namespace truestep::articulation
