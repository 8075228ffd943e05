// Bending of hinges and rods against finite differences and against a plate.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/geometry/make/cloth_grid.h"
#include "engine/kernels/xpbd/dihedral.h"
#include "engine/kernels/xpbd/linear.h"
#include "tests/unit/soft/xpbd_numbers.h"

namespace truestep::xpbd {
namespace {

using testing_numbers::Numbers;
using testing_numbers::slope;

TEST(XpbdBending, DihedralGradientIsItsDerivative) {
  Numbers r;
  const auto angle = [](const std::vector<Vec3>& x) { return dihedral(x[0], x[1], x[2], x[3]).angle; };
  for (int k = 0; k < 50; ++k) {
    const std::vector<Vec3> x = {0.2 * r.vector(), Vec3{1, 0, 0} + 0.2 * r.vector(),
                                 Vec3{0.5, 1, 0} + 0.3 * r.vector(),
                                 Vec3{0.5, -1, 1.5 * r()} + 0.2 * r.vector()};
    const Dihedral d = dihedral(x[0], x[1], x[2], x[3]);
    // The third derivative of the angle, some hundreds, times the step squared: 1e-8.
    for (size_t i = 0; i < 4; ++i) EXPECT_LT(norm(d.slope[i] - slope(angle, x, i)), 1e-7) << i;
  }
  const Dihedral bent = dihedral({0, 0, 0}, {1, 0, 0}, {0.5, 1, 0.2}, {0.5, -1, 0.2});
  EXPECT_NEAR(bent.angle, 2 * std::atan(0.2), 1e-14);
  EXPECT_EQ(dihedral({0, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, -1, 0}).angle, 0);
}

TEST(XpbdBending, DihedralStepIsThePaper) {
  double rows[16] = {0, 0, 0, 1, 1, 0, 0, 2, 0.5, 1, 0.2, 1, 0.5, -1, 0.1, 0.5}, lambda = 0.02;
  const Dihedral d = dihedral({0, 0, 0}, {1, 0, 0}, {0.5, 1, 0.2}, {0.5, -1, 0.1});
  const double weights[4] = {1, 2, 1, 0.5};
  double weight = 0;
  for (size_t i = 0; i < 4; ++i) weight += weights[i] * norm2(d.slope[i]);
  const double step = (-(d.angle - 0.1) - 0.3 * 0.02) / (weight + 0.3);
  const double base[12] = {};
  solve_dihedral<double>({0, 1, 2, 3}, 0.1, {0.3, 0}, 1.0, base, rows, lambda);
  EXPECT_NEAR(lambda - 0.02, step, 1e-15);
  EXPECT_NEAR(rows[10] - 0.2, d.slope[2].z * step, 1e-15);
}

TEST(XpbdBending, HingeAndDihedralAgreeNearFlat) {
  // Both energies of one hinge with D = 1, corners lifted by a small height.
  const double z = 1e-4;
  const Vec3 x0{0, 0, 0}, x1{1, 0, 0}, x2{0.3, 0.8, 0}, x3{0.6, -1.1, 0};
  const Hinge flat = hinge(x0, x1, x2, x3);
  const Vec3 up2{0.3, 0.8, z}, up3{0.6, -1.1, z};
  const Vec3 c = x0 * flat.k[0] + x1 * flat.k[1] + up2 * flat.k[2] + up3 * flat.k[3];
  const double angle = dihedral(x0, x1, up2, up3).angle;
  EXPECT_NEAR(norm2(c) / (2 * flat.area) / (angle * angle / (2 * flat.area)), 1, 1e-6);
}

/// Energy per area over D / (2 R^2) of hinges on a mesh of two directions, spacing 1/20, rolled to a radius
/// of R = 4 about an axis that is turned by `turn`.
double hinge_energy(const Vec3& along, const Vec3& across, double turn) {
  constexpr int kN = 20;
  constexpr double kRadius = 4, kSpacing = 1.0 / kN;
  const double c = std::cos(turn), s = std::sin(turn);
  std::vector<Vec3> flat, rolled;
  for (int j = 0; j <= kN; ++j) {
    for (int i = 0; i <= kN; ++i) {
      const Vec3 p = (i * kSpacing) * along + (j * kSpacing) * across;
      const double u = c * p.x + s * p.y, v = c * p.y - s * p.x;
      flat.push_back(p);
      rolled.push_back({kRadius * std::sin(u / kRadius), v, kRadius * (1 - std::cos(u / kRadius))});
    }
  }
  const auto at = [](int i, int j) { return static_cast<size_t>(j * (kN + 1) + i); };
  double e = 0, area = 0;
  const auto add = [&](size_t a, size_t b, size_t p, size_t q) {
    const Hinge h = hinge(flat[a], flat[b], flat[p], flat[q]);
    const Vec3 sum = rolled[a] * h.k[0] + rolled[b] * h.k[1] + rolled[p] * h.k[2] + rolled[q] * h.k[3];
    e += norm2(sum) / (2 * h.area);
  };
  // Inner cells, cut from (i + 1, j) to (i, j + 1): every hinge belongs to one cell.
  for (int j = 1; j + 1 < kN; ++j) {
    for (int i = 1; i + 1 < kN; ++i) {
      add(at(i + 1, j), at(i, j + 1), at(i, j), at(i + 1, j + 1));
      add(at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j - 1));
      add(at(i, j), at(i, j + 1), at(i + 1, j), at(i - 1, j + 1));
      area += kSpacing * kSpacing * norm(cross(along, across));
    }
  }
  return e / area * 2 * kRadius * kRadius;
}

TEST(XpbdBending, HingesOfEquilateralTrianglesAreAnIsotropicPlate) {
  for (const double turn : {0.0, 0.2, 0.9}) {
    // Second order in spacing / R: 2e-4.
    EXPECT_NEAR(hinge_energy({1, 0, 0}, {0.5, std::sqrt(0.75), 0}, turn), 1, 1e-3) << turn;
  }
  // The control: right triangles are as stiff across their edges and less so in between.
  EXPECT_NEAR(hinge_energy({1, 0, 0}, {0, 1, 0}, 0), 1, 1e-3);
  EXPECT_LT(hinge_energy({1, 0, 0}, {0, 1, 0}, 0.3), 0.9);
}

TEST(XpbdBending, RodsOfAGridAreAnIsotropicPlate) {
  const ClothGridShape shape{.edge_u = {1, 0, 0}, .edge_v = {0, 1, 0}, .nx = 21, .ny = 25};
  const ClothGrid grid = make_cloth_grid(shape);
  const auto energy = [&](double uu, double vv, double uv) {
    double e = 0, area = 0;
    for (const PlateRod& r : plate_rods(shape)) {
      // Inner points, where all four rods are.
      const Vec3 middle = grid.x[r.points[1]];
      if (std::abs(middle.x - 0.5) > 0.4 || std::abs(middle.y - 0.5) > 0.4) continue;
      const auto height = [&](uint32_t i) {
        const Vec3& p = grid.x[i];
        return 0.5 * (uu * p.x * p.x + vv * p.y * p.y) + uv * p.x * p.y;
      };
      const double k = (height(r.points[0]) - 2 * height(r.points[1]) + height(r.points[2])) / r.length2;
      e += 0.5 * r.weight * grid.share[r.points[1]] * k * k;
      if (r.points[2] == r.points[1] + 1) area += grid.share[r.points[1]];
    }
    return e / area;
  };
  const auto plate = [](double uu, double vv, double uv) {
    return 0.5 * (uu * uu + vv * vv + 2.0 / 3 * uu * vv + 4.0 / 3 * uv * uv);
  };
  for (const Vec3& k : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{0.4, -0.7, 0.3}}) {
    EXPECT_NEAR(energy(k.x, k.y, k.z), plate(k.x, k.y, k.z), 1e-12);
  }
}

}  // namespace
}  // namespace truestep::xpbd
