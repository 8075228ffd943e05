// Elastic material laws: stress against differences of the energy, slopes against differences of the stress,
// objectivity, Lame's moduli at rest, and the treatment of slopes that are not definite.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "engine/kernels/fem/material.h"
#include "engine/math/svd3.h"

namespace truestep::fem {
namespace {

constexpr Law kLaws[] = {Law::linear,      Law::corotated,          Law::st_venant_kirchhoff,
                         Law::neo_hookean, Law::stable_neo_hookean, Law::mooney_rivlin};

class Numbers {
 public:
  double operator()() { return spread_(engine_); }
  /// The identity and noise of this size.
  Mat3 near_identity(double noise) {
    Mat3 f = Mat3::identity();
    for (double& c : f.m) c += noise * (*this)();
    return f;
  }
  Mat3 rotation() {
    const Svd3 s = svd3(near_identity(2));
    return s.u * transposed(s.v);
  }

 private:
  std::mt19937 engine_{7};
  std::uniform_real_distribution<double> spread_{-1, 1};
};

using Big = Eigen::Matrix<double, 9, 9, Eigen::RowMajor>;
Big eigen(const Mat9& h) {
  return Eigen::Map<const Big>(h.data());
}
Material some(Law law) {
  return material_of(law, 3, 0.35, law == Law::mooney_rivlin ? 0.2 : 0);
}

TEST(Svd3, GivesRotationsAndTheMatrixBack) {
  Numbers number;
  for (int k = 0; k < 300; ++k) {
    Mat3 a = number.near_identity(2);
    if (k % 5 == 1) a = Mat3::diagonal(1, 1e-9, 1) * a;
    if (k % 5 == 2) a = Mat3::diagonal(1, 0, 1) * a;
    if (k % 5 == 3) a = Mat3::identity();
    if (k % 5 == 4) a = Mat3::diagonal(0, 0, number());
    const Svd3 s = svd3(a);
    const Mat3 back = s.u * Mat3::diagonal(s.s[0], s.s[1], s.s[2]) * transposed(s.v);
    for (size_t i = 0; i < 9; ++i) EXPECT_NEAR(back.m[i], a.m[i], 2e-15 * (1 + s.s[0]));
    for (const Mat3& r : {s.u, s.v}) {
      EXPECT_NEAR(determinant(r), 1, 1e-14);
      const Mat3 one = transposed(r) * r;
      for (size_t i = 0; i < 9; ++i) EXPECT_NEAR(one.m[i], Mat3::identity().m[i], 3e-15);
    }
    EXPECT_GE(s.s[0], s.s[1]);
    EXPECT_GE(s.s[1], std::abs(s.s[2]) - 1e-15);
  }
}

// Central differences with step 1e-5 of numbers of order 1 to 10: 1e-10 from rounding, 1e-9 from the third
// derivative. A wrong factor or a forgotten term is of order 1.
TEST(FemMaterial, StressAndSlopeAreDerivatives) {
  Numbers number;
  constexpr double kStep = 1e-5;
  for (const Law law : kLaws) {
    const Material m = some(law);
    for (int k = 0; k < 20; ++k) {
      const Mat3 f = number.near_identity(0.3);
      const Stress at = stress(m, f);
      const double size = 1 + std::sqrt(inner(at.p, at.p));
      for (size_t i = 0; i < 9; ++i) {
        Mat3 up = f, down = f;
        up.m[i] += kStep, down.m[i] -= kStep;
        const Stress a = stress(m, up), b = stress(m, down);
        EXPECT_NEAR((a.energy - b.energy) / (2 * kStep), at.p.m[i], 1e-7 * size) << static_cast<int>(law);
        for (size_t j = 0; j < 9; ++j) {
          EXPECT_NEAR((a.p.m[j] - b.p.m[j]) / (2 * kStep), at.dp[9 * j + i], 1e-6 * size)
              << static_cast<int>(law);
        }
      }
    }
  }
}

TEST(FemMaterial, DerivativesHoldForInvertedAndFlatElements) {
  Numbers number;
  constexpr double kStep = 1e-7;
  for (const Law law : kLaws) {
    const Material m = some(law);
    for (int k = 0; k < 12; ++k) {
      const Mat3 f = number.rotation() * Mat3::diagonal(1.1, 0.8, k % 2 ? -0.3 : 2e-3) * number.rotation();
      const Stress at = stress(m, f);
      const double size = 1 + eigen(at.dp).norm();
      ASSERT_TRUE(std::isfinite(size));
      for (size_t i = 0; i < 9; ++i) {
        Mat3 up = f, down = f;
        up.m[i] += kStep, down.m[i] -= kStep;
        const Stress a = stress(m, up), b = stress(m, down);
        EXPECT_NEAR((a.energy - b.energy) / (2 * kStep), at.p.m[i], 1e-5 * size) << static_cast<int>(law);
        for (size_t j = 0; j < 9; ++j) {
          EXPECT_NEAR((a.p.m[j] - b.p.m[j]) / (2 * kStep), at.dp[9 * j + i], 1e-4 * size)
              << static_cast<int>(law);
        }
      }
    }
  }
}

TEST(FemMaterial, EnergyDoesNotKnowRotations) {
  Numbers number;
  for (const Law law : kLaws) {
    double worst = 0;
    for (int k = 0; k < 50; ++k) {
      const Mat3 f = number.near_identity(0.4), r = number.rotation();
      worst = std::max(worst, std::abs(stress(some(law), r * f).energy - stress(some(law), f).energy));
      // Isotropic: nor does it depend on directions of the material.
      worst = std::max(worst, std::abs(stress(some(law), f * r).energy - stress(some(law), f).energy));
    }
    // The linear law is the control: it mistakes rotations for strains.
    if (law == Law::linear) {
      EXPECT_GT(worst, 0.1);
    } else {
      EXPECT_LT(worst, 1e-12);
    }
  }
}

TEST(FemMaterial, SlopesAreSymmetricAndLinearElasticAtRest) {
  Numbers number;
  for (const Law law : kLaws) {
    const Material m = some(law);
    EXPECT_NEAR(stress(m, Mat3::identity()).energy, 0, 1e-14);
    const Mat9 rest = stress(m, Mat3::identity()).dp, linear = stress(some(Law::linear), Mat3::identity()).dp;
    for (size_t k = 0; k < 81; ++k) EXPECT_NEAR(rest[k], linear[k], 1e-12) << static_cast<int>(law);
    for (const double p : stress(m, Mat3::identity()).p.m) EXPECT_NEAR(p, 0, 1e-13);
    const Big h = eigen(stress(m, number.near_identity(0.4)).dp);
    EXPECT_LT((h - h.transpose()).norm(), 1e-12 * h.norm());
  }
}

TEST(FemMaterial, DefiniteSlopesAreTheNearestOnes) {
  Numbers number;
  int indefinite = 0;
  for (const Law law : kLaws) {
    const Material m = some(law);
    for (int k = 0; k < 40; ++k) {
      const Mat3 f = k % 4 == 0 ? number.near_identity(0.1)
                                : number.rotation() * Mat3::diagonal(1.3, 0.6, k % 4 == 1 ? -0.4 : 0.3) *
                                      number.rotation();
      Response r;
      respond(m, f, r, nullptr);
      const Volumetric u = volumetric(m, r.theta);
      for (const bool own : {true, false}) {
        const Big h = eigen(slope(m, f, {u, own})), definite = eigen(definite_slope(m, f, {u, own}));
        const Eigen::SelfAdjointEigenSolver<Big> parts(h);
        indefinite += parts.eigenvalues()[0] < -1e-6 * h.norm();
        const Big nearest = parts.eigenvectors() * parts.eigenvalues().cwiseMax(0).asDiagonal() *
                            parts.eigenvectors().transpose();
        EXPECT_LT((definite - nearest).norm(), 1e-9 * h.norm()) << static_cast<int>(law) << ' ' << own;
      }
    }
  }
  EXPECT_GT(indefinite, 50);
}

// Uniaxial stress: lateral stretch and nominal stress for E = 1, nu = 0.3, from the closed form with 30
// digits (reference case fem.uniaxial_nh).
TEST(FemMaterial, NeoHookeanBarHasTheClosedFormsStress) {
  const Material m = material_of(Law::neo_hookean, 1, 0.3);
  for (const auto& [stretch, lateral, nominal] :
       {std::array{0.5, 1.21076739052332292, -0.935352056888197503},
        std::array{0.8, 1.06733836927896849, -0.240005381988022936},
        std::array{1.5, 0.880174591806737791, 0.378280176394318592}}) {
    const Stress s = stress(m, Mat3::diagonal(stretch, lateral, lateral));
    EXPECT_NEAR(s.p(0, 0), nominal, 1e-12);
    EXPECT_NEAR(s.p(1, 1), 0, 1e-12);
    EXPECT_GT(
        std::abs(stress(some(Law::neo_hookean), Mat3::diagonal(stretch, lateral, lateral)).p(0, 0) - nominal),
        0.1);
  }
}

}  // namespace
}  // namespace truestep::fem
