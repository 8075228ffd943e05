// Membrane triangles (kernels/xpbd/membrane.h): iterated on one triangle they solve implicit Euler's equation
// with the gradient of their energy, which is that of plane stress for small strains.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "engine/kernels/xpbd/membrane.h"

namespace truestep {
using namespace xpbd;
namespace {

constexpr size_t kLanes = static_cast<size_t>(Wide<double>::kLanes);
using Places = std::array<Vec3, 3>;

enum class Material { st_venant_kirchhoff, neo_hookean };
constexpr Material kMaterials[] = {Material::st_venant_kirchhoff, Material::neo_hookean};

/// One triangle of right angle and legs 0.5 and 0.4 m in all lanes, each with points of its own.
struct Triangle {
  Material material;
  double modulus = 2000, nu = 0.35, volume = 1e-3;
  std::array<double, 4> inverse{2, 0, 0, 2.5};
  std::array<double, 3> w{1, 2, 0.5};

  double energy(const Places& x) const {
    const Vec3 e1 = x[1] - x[0], e2 = x[2] - x[0];
    const Vec3 f1 = e1 * inverse[0] + e2 * inverse[2], f2 = e1 * inverse[1] + e2 * inverse[3];
    return modulus * volume *
           (material == Material::neo_hookean ? neo_hookean_membrane : st_venant_kirchhoff_membrane)(f1, f2,
                                                                                                     nu);
  }
  Vec3 gradient(Places x, size_t i) const {
    const auto at = [&](Vec3 by) {
      Places y = x;
      y[i] += by;
      return energy(y);
    };
    const double e = 1e-6;
    return Vec3{at({e, 0, 0}) - at({-e, 0, 0}), at({0, e, 0}) - at({0, -e, 0}),
                at({0, 0, e}) - at({0, 0, -e})} /
           (2 * e);
  }
  /// Where `iterations` move points that would be at `x` after a step of h.
  Places solve(const Places& x, double h, int iterations, double compliance) const {
    std::array<double, 4 * 3 * kLanes> rows{};
    std::array<uint32_t, 3 * kLanes> points{};
    std::array<double, 4 * kLanes> k{};
    std::array<double, kLanes> alpha{};
    std::array<double, 3 * kLanes> lambda{};
    std::array<double, 6 * kLanes> base{};
    for (size_t lane = 0; lane < kLanes; ++lane) {
      alpha[lane] = compliance;
      for (size_t i = 0; i < 4; ++i) k[i * kLanes + lane] = inverse[i];
      for (size_t i = 0; i < 3; ++i) {
        const size_t row = 3 * lane + i;
        points[i * kLanes + lane] = static_cast<uint32_t>(row);
        rows[4 * row] = x[i].x, rows[4 * row + 1] = x[i].y, rows[4 * row + 2] = x[i].z,
                 rows[4 * row + 3] = w[i];
      }
    }
    const MembraneSet<double> set{points.data(), k.data(), alpha.data(), nu, lambda.data(), base.data()};
    const auto per = per_step<double>(h);
    for (int n = 0; n < iterations; ++n) {
      if (material == Material::neo_hookean) {
        solve_neo_hookean_membrane<double>(set, per, rows.data());
      } else {
        solve_st_venant_kirchhoff<double>(set, per, 1.0, rows.data());
      }
    }
    const size_t last = 3 * (kLanes - 1);
    const auto place = [&](size_t i) {
      const double* r = rows.data() + 4 * (last + i);
      return Vec3{r[0], r[1], r[2]};
    };
    return {place(0), place(1), place(2)};
  }
};

TEST(XpbdMembrane, AShortStepFollowsTheEnergysGradient) {
  const Places sought{Vec3{0.02, 0, 0.03}, Vec3{0.6, 0.05, 0}, Vec3{-0.1, 0.42, 0.08}};
  const double h = 1e-3;
  for (const Material m : kMaterials) {
    const Triangle t{m};
    const auto residual = [&](const Triangle& of) {
      const Places x = t.solve(sought, h, 1, 1 / (t.modulus * t.volume));
      double worst = 0, size = 0;
      for (size_t i = 0; i < 3; ++i) {
        const Vec3 pull = (x[i] - sought[i]) * (1 / (t.w[i] * h * h));
        worst = std::max(worst, norm(pull + of.gradient(sought, i)));
        size = std::max(size, norm(pull));
      }
      return worst / size;
    };
    // E V w / l^2 h^2 of 2 J, 2 / kg, 0.4 m is 3e-5, and a few times that where the strain is large.
    EXPECT_LT(residual(t), 2e-4) << static_cast<int>(m);
    Triangle stiffer{t};
    stiffer.modulus *= 1.01;
    EXPECT_GT(residual(stiffer), 5e-3) << "the control";
  }
}

TEST(XpbdMembrane, RestsAtRestWhateverItsPlace) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Places rest{Vec3{1, 2, 3}, Vec3{1 + 0.5 * c, 2, 3 + 0.5 * s}, Vec3{1, 2.4, 3}};
  for (const Material m : kMaterials) {
    const Triangle t{m};
    const Places x = t.solve(rest, 0.01, 1, 1 / (t.modulus * t.volume));
    // Rounding of places of 3 m.
    for (size_t i = 0; i < 3; ++i) EXPECT_LT(norm(x[i] - rest[i]), 1e-14);
  }
}

TEST(XpbdMembrane, SmallStrainsArePlaneStress) {
  const double e = 1e-4, nu = 0.35;
  for (const Material m : kMaterials) {
    const auto energy = [&](double a, double b, double g) {
      const Vec3 f1{1 + a, 0, 0}, f2{g, 1 + b, 0};
      return m == Material::neo_hookean ? neo_hookean_membrane(f1, f2, nu)
                                        : st_venant_kirchhoff_membrane(f1, f2, nu);
    };
    // Second order in e; the third is smaller by about e.
    const double along = 0.5 / (1 - nu * nu) * e * e;
    EXPECT_NEAR(energy(e, 0, 0), along, 5 * e * along);
    EXPECT_NEAR(energy(e, -nu * e, 0), 0.5 * e * e, 5 * e * along) << "Young's modulus in uniaxial stress";
    EXPECT_NEAR(energy(0, 0, e), 0.25 / (1 + nu) * e * e, 5 * e * along) << "shear modulus";
  }
}

TEST(XpbdMembrane, WithoutComplianceStrainIsGone) {
  const Places sought{Vec3{0.02, 0, 0.03}, Vec3{0.9, 0.05, 0}, Vec3{-0.1, 0.7, 0.08}};
  const Triangle t{Material::st_venant_kirchhoff};
  const Places x = t.solve(sought, 0.01, 30, 0);
  EXPECT_NEAR(norm(x[1] - x[0]), 0.5, 1e-9);
  EXPECT_NEAR(norm(x[2] - x[0]), 0.4, 1e-9);
  EXPECT_NEAR(dot(x[1] - x[0], x[2] - x[0]), 0, 1e-9);
  // Momentum stays.
  Vec3 before, after;
  for (size_t i = 0; i < 3; ++i) before += sought[i] / t.w[i], after += x[i] / t.w[i];
  EXPECT_LT(norm(after - before), 1e-13);
}

}  // namespace
}  // namespace truestep
