// The O(n) solver for Newton's linear systems of a tree against a dense solution from differences of the
// right-hand side: all joints, any z, forces with a fixed direction, drives, limits.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <complex>
#include <functional>

#include "engine/core/equations/linear_solver.h"
#include "engine/core/state/workspace.h"
#include "engine/systems/articulation/articulation_field.h"
#include "engine/systems/articulation/tree_newton.h"
#include "tests/unit/articulation/random_tree.h"

namespace truestep::articulation {
using namespace articulation;
namespace {

using Function = std::function<void(const std::vector<double>&, std::vector<double>&)>;

// df/dy by central differences of fourth order.
Eigen::MatrixXd jacobian(const Function& f, const std::vector<double>& y) {
  const auto n = static_cast<Eigen::Index>(y.size());
  Eigen::MatrixXd J(n, n);
  std::vector<double> rate(y.size());
  const double e = 1e-3;
  for (size_t j = 0; j < y.size(); ++j) {
    Eigen::VectorXd column = Eigen::VectorXd::Zero(n);
    for (const auto& [step, weight] : {std::pair{-2.0, 1.0}, {-1.0, -8.0}, {1.0, 8.0}, {2.0, -1.0}}) {
      auto moved = y;
      moved[j] += step * e;
      f(moved, rate);
      column += weight / (12 * e) * Eigen::Map<Eigen::VectorXd>(rate.data(), n);
    }
    J.col(static_cast<Eigen::Index>(j)) = column;
  }
  return J;
}

// Of the solution, relative.
double error(const Eigen::MatrixXd& J, double z, const std::vector<double>& b, const std::vector<double>& x) {
  const auto n = J.rows();
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n) - z * J;
  const Eigen::VectorXd exact = A.partialPivLu().solve(Eigen::Map<const Eigen::VectorXd>(b.data(), n));
  return (Eigen::Map<const Eigen::VectorXd>(x.data(), n) - exact).norm() / exact.norm();
}

TEST(ArticulatedNewton, SolvesTreesOfAllJointsAsADenseMatrixDoes) {
  Draw draw{3};
  for (int k = 0; k < 60; ++k) {
    const Tree tree = random_tree(draw, 1 + k % 9);
    const size_t nx = tree.positions, nv = tree.velocities, n = nx + nv;
    if (nv == 0) continue;
    std::vector<double> y(n), b(n);
    for (double& c : y) c = draw();
    for (double& c : b) c = draw();
    std::vector<Push> pushes;
    if (k % 3 > 0) {
      const auto node = static_cast<int32_t>(tree.nodes.size()) - 1;
      pushes.push_back({.node = node,
                        .at = draw.vector(),
                        .force = draw.vector() * 20.0,
                        .torque = draw.vector() * 20.0,
                        .axes = k % 3 == 1 ? Push::Axes::world : Push::Axes::node});
      pushes.push_back({.node = node / 2, .at = draw.vector(), .force = draw.vector() * 20.0});
    }
    std::vector<DriveSlope> drives(tree.nodes.size());
    for (size_t i = 0; i < drives.size(); ++i) {
      if (tree.nodes[i].move == Move::spherical) continue;
      for (size_t j = 0; j < 3; ++j) drives[i].stiffness[j][j] = 5 * (1 + draw());
      drives[i].damping = 1 + draw();
    }
    const Vec3 gravity{1, -9.81, 2};
    Work work(tree.nodes.size());
    const Function f = [&](const std::vector<double>& at, std::vector<double>& out) {
      const std::span<const double> q{at.data(), nx}, v{at.data() + nx, nv};
      std::vector<double> tau(nv, 0.0);
      for (size_t i = 0; i < drives.size(); ++i) {
        const Node& node = tree.nodes[i];
        for (uint32_t j = 0; j < velocities_of(node.move); ++j) {
          tau[node.v + j] = 3 - drives[i].damping * v[node.v + j];
          if (node.move != Move::spherical) tau[node.v + j] -= drives[i].stiffness[j][j] * q[node.q + j];
        }
      }
      position_rate(tree, q, v, {out.data(), nx});
      accelerations(tree, q, v, tau, gravity, pushes, work, {out.data() + nx, nv});
    };
    const Eigen::MatrixXd J = jacobian(f, y);
    std::vector<double> rate(n);
    f(y, rate);
    LinearTree linear;
    linear.linearise(tree, {y.data(), nx}, {y.data() + nx, nv}, {rate.data() + nx, nv}, work, pushes, drives);
    for (const double z : {1e-3, 0.02, 0.15}) {
      TreeFactors<double> factors;
      ASSERT_TRUE(factors.factor(linear, z));
      auto x = b;
      factors.solve(linear, x.data(), x.data() + nx);
      // Differences are accurate to some 1e-9 where a quaternion of random length rotates fast.
      EXPECT_LT(error(J, z, b, x), 1e-6) << k << ' ' << z;
      EXPECT_GT(error(J, 1.2 * z, b, x), 2e-5) << "control: another z";
    }
    // Complex, with a real right-hand side.
    using C = std::complex<double>;
    const C z{0.05, 0.03};
    TreeFactors<Complex> factors;
    ASSERT_TRUE(factors.factor(linear, Complex{z.real(), z.imag()}));
    std::vector<Complex> x(n);
    Eigen::VectorXcd right(static_cast<Eigen::Index>(n));
    for (size_t i = 0; i < n; ++i) {
      x[i] = {b[i], 0.5};
      right[static_cast<Eigen::Index>(i)] = C(b[i], 0.5);
    }
    factors.solve(linear, x.data(), x.data() + nx);
    const Eigen::MatrixXcd A = Eigen::MatrixXcd::Identity(J.rows(), J.rows()) - z * J.cast<C>();
    const Eigen::VectorXcd exact = A.partialPivLu().solve(right);
    for (size_t i = 0; i < n; ++i) {
      const C e = exact[static_cast<Eigen::Index>(i)];
      EXPECT_NEAR(x[i].re, e.real(), 1e-6 * exact.norm()) << k;
      EXPECT_NEAR(x[i].im, e.imag(), 1e-6 * exact.norm()) << k;
    }
  }
}

TEST(ArticulatedNewton, SolvesForAccelerationsWhereRatesArePlain) {
  Draw draw{5};
  Tree tree;
  for (int i = 0; i < 6; ++i) {
    Node node;
    node.move = i % 2 ? Move::prismatic : Move::revolute;
    node.parent = i - 1, node.axis = normalized(draw.vector());
    node.frame = {rotation(draw.quaternion()), draw.vector()};
    node.inertia = body(draw);
    tree.add(node);
  }
  const size_t n = tree.velocities;
  std::vector<double> y(2 * n), b(n);
  for (double& c : y) c = draw();
  for (double& c : b) c = draw();
  const std::vector<double> tau(n, 1.0);
  const std::vector<DriveSlope> drives(n);
  Work work(n);
  const Function f = [&](const std::vector<double>& at, std::vector<double>& out) {
    std::copy_n(at.data() + n, n, out.data());
    accelerations(tree, {at.data(), n}, {at.data() + n, n}, tau, {0, -9.81, 0}, {}, work,
                  {out.data() + n, n});
  };
  const Eigen::MatrixXd J = jacobian(f, y);
  std::vector<double> rate(2 * n);
  f(y, rate);
  LinearTree linear;
  linear.linearise(tree, {y.data(), n}, {y.data() + n, n}, {rate.data() + n, n}, work, {}, drives);
  TreeFactors<double> factors;
  ASSERT_TRUE(factors.factor_second_order(linear, 0.02, 0.3));
  auto x = b;
  factors.solve_second_order(linear, x.data());
  const auto m = static_cast<Eigen::Index>(n);
  const Eigen::MatrixXd A =
      Eigen::MatrixXd::Identity(m, m) - 0.02 * J.bottomLeftCorner(m, m) - 0.3 * J.bottomRightCorner(m, m);
  const Eigen::VectorXd exact = A.partialPivLu().solve(Eigen::Map<Eigen::VectorXd>(b.data(), m));
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), m) - exact).norm(), 1e-7 * exact.norm());
}

// A ball with a spring, hinges beyond and within limits, a load with a fixed direction: through the field.
TEST(ArticulatedNewton, DrivesAnswerWithTheirSlopes) {
  ArticulationDef d;
  LinkDef ball;
  ball.joint = JointType::spherical, ball.mass = 2, ball.center = {0.1, -0.5, 0},
  ball.inertia = {0.3, 0.2, 0.4};
  ball.q = {0.8, 0.36, -0.48, 0}, ball.v = {1, -2, 0.5}, ball.stiffness = 30, ball.damping = 2;
  ball.force = {3, 40, -5};
  LinkDef hinge;
  hinge.mass = 1, hinge.center = {0, -1, 0.2}, hinge.offset = {0, -1, 0}, hinge.q = {0.7}, hinge.v = {0.3};
  hinge.highest = 0.5, hinge.limit_stiffness = 80, hinge.limit_damping = 4, hinge.stiffness = 6,
  hinge.rest = 1;
  LinkDef within = hinge;
  within.q = {0.2}, within.axis = {1, 1, 0};
  d.links = {ball, hinge, within};
  const ArticulationField field(build_model(d), {0, -9.81, 0});
  const State state = field.initial_state();
  const ThreadArena arena(1);
  Workspace workspace;
  Evaluation e{workspace, arena};
  const size_t nx = 6, nv = 5;
  std::vector<double> y(nx + nv), b(nx + nv);
  std::copy_n(state.f64(Columns::kPosition).data(), nx, y.data());
  std::copy_n(state.f64(Columns::kVelocity).data(), nv, y.data() + nx);
  Draw draw{9};
  for (double& c : b) c = draw();
  const Function f = [&](const std::vector<double>& at, std::vector<double>& out) {
    const Phase phase{0, {at.data(), nx}, {at.data() + nx, nv}, state};
    field.position_rate(phase, {out.data(), nx}, e);
    field.acceleration(phase, {out.data() + nx, nv}, e);
  };
  const Eigen::MatrixXd J = jacobian(f, y);
  const auto solver = field.linear_solver();
  ASSERT_TRUE(solver);
  solver->linearise({0, {y.data(), nx}, {y.data() + nx, nv}, state}, e);
  ASSERT_TRUE(solver->factor(0.05));
  auto x = b;
  solver->solve(x.data());
  EXPECT_LT(error(J, 0.05, b, x), 1e-8);
}

}  // namespace
}  // namespace truestep::articulation
