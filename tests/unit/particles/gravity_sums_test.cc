// Sums over all pairs against the plain double loop, and the softened laws against their own potentials.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "engine/kernels/gravity/direct_sums.h"
#include "engine/math/vec3.h"

namespace truestep::gravity {
namespace {

/// w and p of one pair at distance r.
std::pair<double, double> law(SofteningKind kind, double eps, double r) {
  const ThreadArena one(1);
  const std::vector<double> x{0, 0, 0, r, 0, 0}, mu{1, 1};
  std::vector<double> a(6);
  DirectScratch scratch;
  direct_accelerations({x, mu}, {kind, eps}, a, scratch, one);
  return {a[0] / r, direct_potential({x, mu}, {kind, eps}, scratch, one)};
}

TEST(GravitySums, NewtonsLawOverAllSizesOfDistance) {
  double worst = 0;
  for (int k = 0; k < 2000; ++k) {
    const double r = std::ldexp(1 + k / 2000.0, k % 200 - 100);
    const auto [w, p] = law(SofteningKind::plummer, 0, r);
    worst = std::max({worst, std::abs(p * r - 1), std::abs(w * r * r * r - 1) / 3});
  }
  EXPECT_LT(worst, 8e-16) << "a few units of the last place";
}

/// Numbers in [0, 1), a column.
std::vector<double> column(size_t n, uint64_t stream) {
  std::vector<double> out;
  for (size_t i = 0; i < n; ++i) out.push_back(uniform4(9, stream, i)[0]);
  return out;
}

TEST(GravitySums, EveryProcessorsLoopsGiveTheSameBits) {
  const PairLoops &plain = plain_pair_loops(), &own = pair_loops();
  if (&plain == &own) GTEST_LOG_(INFO) << "this processor has no wider loops";
  for (LawLoops PairLoops::*law : {&PairLoops::newton, &PairLoops::plummer, &PairLoops::spline}) {
    const LawNumbers numbers{0.3, 1e-20};
    const auto x = column(64, 1), y = column(64, 2), z = column(64, 3), mu = column(64, 4);
    const auto sums = [&](const LawLoops& l) {
      std::vector<double> a(192, 0.25);
      const PairColumns c{x.data(), y.data(), z.data(), mu.data(), a.data(), a.data() + 64, a.data() + 128};
      l.direct.own(c, numbers, 0, 32), l.direct.cross(c, numbers, 0, 32, 32, 64);
      a.push_back(l.direct.potential(c, numbers, 3, 5, 0, 64));
      return a;
    };
    EXPECT_EQ(sums(plain.*law), sums(own.*law));
    // Control: the sums depend on the data.
    EXPECT_NE(sums(plain.newton), sums(plain.plummer));

    const auto floats = [&](const LawLoops& l) {
      std::vector<float> at(96), out(128);
      for (size_t i = 0; i < 96; ++i) at[i] = static_cast<float>(uniform4(9, 5, i)[1]);
      const GroupColumns<float> g{at.data(),       at.data() + 32,  at.data() + 64,  out.data(),
                                  out.data() + 32, out.data() + 64, out.data() + 96, 32};
      const std::vector<BodySource<float>> bodies{{0.1f, 0.2f, 0.3f, 0.4f}, {0.9f, 0.2f, 0.7f, 0.3f}};
      const std::vector<NodeSource> nodes{{2, 3, 1, 0.5f, {0.1f, 0.02f, 0.03f, 0.2f, 0.01f, 0.3f, 0.3f, 0}}};
      l.bodies.with_potentials(g, bodies.data(), 2, numbers),
          l.nodes.with_potentials(g, nodes.data(), 1, numbers);
      l.bodies.accelerations(g, bodies.data(), 2, numbers),
          l.nodes.accelerations(g, nodes.data(), 1, numbers);
      return out;
    };
    EXPECT_EQ(floats(plain.*law), floats(own.*law));
    const auto doubles = [&](const LawLoops& l) {
      std::vector<double> at = column(96, 6), out(128);
      const GroupColumns<double> g{at.data(),       at.data() + 32,  at.data() + 64,  out.data(),
                                   out.data() + 32, out.data() + 64, out.data() + 96, 32};
      const std::vector<BodySource<double>> bodies{{0.1, 0.2, 0.3, 0.4}, {0.9, 0.2, 0.7, 0.3}};
      l.near_bodies.with_potentials(g, bodies.data(), 2, numbers),
          l.near_bodies.accelerations(g, bodies.data(), 2, numbers);
      return out;
    };
    EXPECT_EQ(doubles(plain.*law), doubles(own.*law));
  }
}

TEST(GravitySums, ForceIsTheSlopeOfThePotential) {
  for (const SofteningKind kind : {SofteningKind::plummer, SofteningKind::spline}) {
    for (const double r : {0.02, 0.1, 0.139, 0.141, 0.2, 0.279, 0.281, 0.5, 3.0}) {
      const double d = 1e-5, slope = (law(kind, 0.1, r - d).second - law(kind, 0.1, r + d).second) / (2 * d);
      // d^2/6 p''' <= 2e-11 * 6/eps^4 of a force of at most 1/eps^2.
      EXPECT_NEAR(law(kind, 0.1, r).first * r, slope, 2e-5) << r;
    }
  }
  // Both are equally deep in the centre, and Newton's law holds outside the spline's support but not for
  // Plummer's.
  EXPECT_NEAR(law(SofteningKind::spline, 0.1, 0).second, 10, 1e-12);
  EXPECT_NEAR(law(SofteningKind::plummer, 0.1, 0).second, 10, 1e-12);
  EXPECT_NEAR(law(SofteningKind::spline, 0.1, 0.2801).first, std::pow(0.2801, -3),
              1e-12 * std::pow(0.2801, -3));
  EXPECT_GT(std::abs(law(SofteningKind::plummer, 0.1, 0.2801).first * std::pow(0.2801, 3) - 1), 0.1);
}

TEST(GravitySums, EveryNumberOfBodiesMatchesTheDoubleLoop) {
  const ThreadArena one(1), two(2);
  for (const size_t n : {1, 2, 3, 5, 63, 64, 65, 257, 700, 1030}) {
    std::vector<double> x, mu;
    for (size_t i = 0; i < n; ++i) {
      const auto u = uniform4(3, 1, i);
      x.insert(x.end(), {u[0], u[1], u[2]});
      mu.push_back(i % 5 == 4 ? 0 : u[3]);
    }
    DirectScratch scratch;
    std::vector<double> a(3 * n), other(3 * n);
    const Softening s{SofteningKind::plummer, 0.01};
    direct_accelerations({x, mu}, s, a, scratch, one);
    direct_accelerations({x, mu}, s, other, scratch, two);
    EXPECT_EQ(a, other) << n;
    double potential = 0, worst = 0;
    for (size_t i = 0; i < n; ++i) {
      Vec3 sum;
      double size = 0;
      for (size_t j = 0; j < n; ++j) {
        const Vec3 d = load3(x.data(), j) - load3(x.data(), i);
        const double r = std::sqrt(norm2(d) + 1e-4);
        sum += d * (mu[j] / (r * r * r)), size += mu[j] / (r * r);
        if (j > i) potential += mu[i] * mu[j] / r;
      }
      worst = std::max(worst, norm(sum - load3(a.data(), i)) / std::max(size, 1e-300));
    }
    // A sum of n terms in two orders: n roundings at most, their root in the mean.
    EXPECT_LT(worst, 4e-16 * std::sqrt(static_cast<double>(n)) + 1e-15) << n;
    EXPECT_NEAR(direct_potential({x, mu}, s, scratch, one), potential, 1e-13 * potential + 1e-300) << n;
  }
}

}  // namespace
}  // namespace truestep::gravity
