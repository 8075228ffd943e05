// The bending kernel: forces are minus the gradient of the energy, slopes are its second derivatives, a
// circle has the energy of a bent rod, and the matrix assumed to be positive is.
#include "engine/kernels/springs/bending.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace truestep::bending {
namespace {

constexpr double kB = 0.7;
const Vec3 kPoints[3] = {{0.1, 0, 0.2}, {1, 0.3, 0}, {1.4, 1.1, 0.5}};

double energy_at(const Vec3 x[3]) {
  return energy(links(x[0], x[1], x[2]), kB);
}
double& component(Vec3& v, int k) {
  return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

TEST(Bending, ForcesAreMinusTheGradientAndConserveMomentum) {
  const auto f = forces(links(kPoints[0], kPoints[1], kPoints[2]), kB);
  Vec3 sum, torque;
  for (int i = 0; i < 3; ++i) {
    sum += f[size_t(i)], torque += cross(kPoints[i], f[size_t(i)]);
    for (int k = 0; k < 3; ++k) {
      Vec3 up[3] = {kPoints[0], kPoints[1], kPoints[2]}, down[3] = {kPoints[0], kPoints[1], kPoints[2]};
      constexpr double kStep = 1e-6;
      component(up[i], k) += kStep, component(down[i], k) -= kStep;
      Vec3 force = f[size_t(i)];
      EXPECT_NEAR(component(force, k), -(energy_at(up) - energy_at(down)) / (2 * kStep), 1e-9);
    }
  }
  EXPECT_LT(norm(sum), 1e-15);
  EXPECT_LT(norm(torque), 1e-15);
}

TEST(Bending, SlopesAreTheForcesDerivatives) {
  const Hessian h = hessian(links(kPoints[0], kPoints[1], kPoints[2]), kB);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto block = force_slope(h, i, j);
      for (int c = 0; c < 3; ++c) {
        Vec3 up[3] = {kPoints[0], kPoints[1], kPoints[2]}, down[3] = {kPoints[0], kPoints[1], kPoints[2]};
        constexpr double kStep = 1e-6;
        component(up[j], c) += kStep, component(down[j], c) -= kStep;
        Vec3 d = (forces(links(up[0], up[1], up[2]), kB)[size_t(i)] -
                  forces(links(down[0], down[1], down[2]), kB)[size_t(i)]) /
                 (2 * kStep);
        for (int r = 0; r < 3; ++r) EXPECT_NEAR(block[size_t(3 * r + c)], component(d, r), 1e-8);
      }
    }
  }
}

TEST(Bending, DefiniteSlopesAreDefiniteAndExactWhereStraight) {
  const auto whole = [](const Hessian& h) {
    Eigen::Matrix<double, 9, 9> m;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const auto block = force_slope(h, i, j);
        for (int k = 0; k < 9; ++k) m(3 * i + k / 3, 3 * j + k % 3) = -block[size_t(k)];
      }
    }
    return m;
  };
  const Links bent = links(kPoints[0], kPoints[1], kPoints[2]);
  const auto m = whole(definite_hessian(bent, kB));
  EXPECT_LT((m - m.transpose()).norm(), 1e-14);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(m).eigenvalues()[0], -1e-12);
  // The control: the exact matrix is not.
  EXPECT_LT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(whole(hessian(bent, kB))).eigenvalues()[0], -1e-3);
  const Links straight = links({0, 0, 0}, {1, 0, 0}, {3, 0, 0});
  EXPECT_LT((whole(hessian(straight, kB)) - whole(definite_hessian(straight, kB))).norm(), 1e-14);
}

TEST(Bending, ACircleHasTheEnergyOfABentRod) {
  // EI / 2 kappa^2 times the length: EI pi / R. Chords of a regular polygon: 2 tan(pi / n) instead of 2 pi /
  // n.
  constexpr int kLinks = 100;
  constexpr double kStiffness = 2, kRadius = 0.5, kPi = 3.141592653589793;
  const double l = 2 * kRadius * std::sin(kPi / kLinks);
  const auto at = [&](int k) {
    return Vec3{kRadius * std::cos(2 * kPi * k / kLinks), kRadius * std::sin(2 * kPi * k / kLinks), 0};
  };
  double sum = 0;
  for (int k = 0; k < kLinks; ++k) sum += energy(links(at(k), at(k + 1), at(k + 2)), kStiffness / l);
  EXPECT_NEAR(sum, kStiffness * kPi / kRadius, 1e-3 * kStiffness * kPi / kRadius);
}

}  // namespace
}  // namespace truestep::bending
