// Kernels of soft bodies of the system xpbd: shape matching and stable Neo-Hookean tetrahedra.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "engine/kernels/xpbd/neo_hookean.h"
#include "engine/kernels/xpbd/shape_match.h"
#include "engine/math/quaternion.h"

namespace truestep {
using namespace xpbd;
namespace {

Mat3 turn_of(double angle, const Vec3& axis) {
  const Vec3 a = normalized(axis) * std::sin(angle / 2);
  const Rotation r = rotation(Quat{std::cos(angle / 2), a.x, a.y, a.z});
  Mat3 out;
  for (size_t c = 0; c < 3; ++c) {
    const Vec3 e = r.apply({c == 0 ? 1.0 : 0, c == 1 ? 1.0 : 0, c == 2 ? 1.0 : 0});
    out(0, c) = e.x, out(1, c) = e.y, out(2, c) = e.z;
  }
  return out;
}

TEST(XpbdShapeMatch, FindsTheTurnBehindAStretch) {
  const Mat3 turn = turn_of(2.5, {1, -2, 0.5}), stretch = Mat3::diagonal(1.4, 0.8, 1.1);
  const Mat3 found = match_transform(turn * stretch, Mat3::identity(), 0);
  // Rounding of a decomposition of numbers about 1.
  for (size_t k = 0; k < 9; ++k) EXPECT_NEAR(found.m[k], turn.m[k], 1e-14);
  // Mirrored points are rotated all the same.
  EXPECT_NEAR(determinant(match_transform(Mat3::diagonal(1, 1, -0.5), Mat3::identity(), 0)), 1, 1e-14);
}

TEST(XpbdShapeMatch, ALinearGoalKeepsTheVolume) {
  const Mat3 turn = turn_of(0.7, {0, 1, 1}), stretch = Mat3::diagonal(1.5, 0.9, 1.2);
  const Mat3 spread = Mat3::diagonal(2, 3, 4), all = turn * stretch;
  const Mat3 goal = match_transform(all * spread, inverse_or_zero(spread), 1);
  EXPECT_NEAR(determinant(goal), 1, 1e-12);
  for (size_t k = 0; k < 9; ++k) EXPECT_NEAR(goal.m[k], all.m[k] / std::cbrt(1.5 * 0.9 * 1.2), 1e-12);
  // Flat points and inverted ones are rotated alone.
  const Mat3 flat =
      match_transform(all * Mat3::diagonal(2, 3, 0), inverse_or_zero(Mat3::diagonal(2, 3, 0)), 0.9);
  EXPECT_NEAR(determinant(flat), 1, 1e-14);
  const Mat3 inside_out = match_transform(Mat3::diagonal(1, 1, -1), Mat3::identity(), 0.9);
  EXPECT_NEAR(determinant(inside_out), 1, 1e-14);
}

/// One tetrahedron in all lanes, each with points of its own.
struct Elastic {
  static constexpr size_t kLanes = static_cast<size_t>(Wide<double>::kLanes);
  std::array<Vec3, 4> rest{Vec3{0.1, 0, 0}, Vec3{1, 0.2, 0}, Vec3{0, 1.1, 0.1}, Vec3{0.2, 0.1, 0.9}};
  double mu = 300, nu = 0.4;
  std::array<double, 4> w{1, 2, 0.5, 0};

  static Mat3 edges(const std::array<Vec3, 4>& x) {
    const Vec3 a = x[1] - x[0], b = x[2] - x[0], c = x[3] - x[0];
    return {{a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z}};
  }
  Mat3 inverse() const { return (1 / determinant(edges(rest))) * transposed(cofactor(edges(rest))); }
  double volume() const { return determinant(edges(rest)) / 6; }
  double energy(const std::array<Vec3, 4>& x) const {
    return neo_hookean_energy(edges(x) * inverse(), volume(), mu, 1 - 2 * nu);
  }
  /// Displacements of the points in a step of h from x.
  std::array<Vec3, 4> step(const std::array<Vec3, 4>& x, double h) const {
    std::vector<uint32_t> points(4 * kLanes);
    alignas(64) std::array<double, 9 * kLanes> inverses, base;
    alignas(64) std::array<double, kLanes> compliance;
    alignas(64) std::array<double, 16 * kLanes> rows{};
    const Mat3 b = inverse(), e = edges(x);
    for (size_t lane = 0; lane < kLanes; ++lane) {
      compliance[lane] = 1 / (mu * volume());
      for (size_t i = 0; i < 4; ++i) {
        points[i * kLanes + lane] = static_cast<uint32_t>(4 * lane + i), rows[4 * (4 * lane + i) + 3] = w[i];
      }
      for (size_t k = 0; k < 9; ++k) {
        inverses[k * kLanes + lane] = b.m[k], base[k * kLanes + lane] = e(k % 3, k / 3);
      }
    }
    solve_neo_hookean<double>(
        {points.data(), inverses.data(), compliance.data(), 1 - 2 * nu, nullptr, base.data()},
        per_step<double>(h), rows.data());
    std::array<Vec3, 4> out;
    const size_t last = 4 * (kLanes - 1);
    for (size_t i = 0; i < 4; ++i)
      out[i] = {rows[4 * (last + i)], rows[4 * (last + i) + 1], rows[4 * (last + i) + 2]};
    return out;
  }
};

TEST(XpbdNeoHookean, RestsAtRestAndInAnyPlace) {
  const Elastic t;
  const Mat3 turn = turn_of(1.9, {1, 1, -3});
  std::array<Vec3, 4> x;
  for (size_t i = 0; i < 4; ++i) x[i] = turn * t.rest[i] + Vec3{5, -3, 2};
  EXPECT_NEAR(t.energy(x), 0, 1e-12 * t.mu);
  // Both multipliers are as large as a displacement of a metre per constraint, and cancel to their rounding.
  for (const Vec3& by : t.step(x, 0.1)) EXPECT_LT(norm(by), 1e-13);
}

TEST(XpbdNeoHookean, AShortStepFollowsTheEnergysGradient) {
  const Elastic t;
  // Stretched and sheared; then inside out.
  for (const double z : {1.0, -0.6}) {
    std::array<Vec3, 4> x = t.rest;
    x[1] = x[1] + Vec3{0.2, -0.1, 0.3}, x[3] = {0.3, 0.2, 0.9 * z};
    const double h = 1e-5, d = 1e-6;
    const auto by = t.step(x, h);
    for (size_t i = 0; i < 4; ++i) {
      Vec3 slope;
      for (int a = 0; a < 3; ++a) {
        auto up = x, down = x;
        (&up[i].x)[a] += d, (&down[i].x)[a] -= d;
        (&slope.x)[a] = (t.energy(up) - t.energy(down)) / (2 * d);
      }
      // -h^2 w grad E, but for h^2 w k of about 1e-7 of it, and central differences of 1e-6.
      EXPECT_LT(norm(by[i] + slope * (h * h * t.w[i])), 1e-6 * norm(slope) * h * h) << i;
      EXPECT_GT(norm(slope), 1);
    }
  }
}

TEST(XpbdNeoHookean, HasTheLameConstantsOfItsModuli) {
  const Elastic t;
  // Uniaxial strain e: V (lambda / 2 + mu) e^2 with lambda = 2 mu nu / (1 - 2 nu); third order e, 1e-4 of it.
  const double e = 1e-4, lambda = 2 * t.mu * t.nu / (1 - 2 * t.nu);
  const double energy = neo_hookean_energy(Mat3::diagonal(1 + e, 1, 1), 2, t.mu, 1 - 2 * t.nu);
  EXPECT_NEAR(energy, 2 * (0.5 * lambda + t.mu) * e * e, 1e-3 * energy);
}

}  // namespace
}  // namespace truestep
