// Velocities and curls of stream functions: no divergence, no curl of a gradient, and the promised order.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "engine/kernels/mac/fourth_order.h"
#include "engine/kernels/mac/ghosts.h"
#include "engine/kernels/mac/stream_function.h"

namespace truestep::mac {
namespace {

struct Plane {
  MacGrid g;
  std::vector<double> psi, u, v, out;
  ThreadArena arena{1};
  explicit Plane(size_t cells) {
    g.cells = {cells, cells, 1};
    g.spacing = {1.0 / static_cast<double>(cells), 1.0 / static_cast<double>(cells), 1};
    for (auto* a : {&psi, &u, &v, &out}) a->assign(g.size(), 0);
  }
  Fields fields() { return {u.data(), v.data(), nullptr}; }
  ConstFields known() const { return {u.data(), v.data(), nullptr}; }
  // 0 on the sides, where the flow runs along them at rest except at the upper one: u = sin(pi x)^2 there.
  static double stream(double x, double y) {
    const double s = std::sin(std::numbers::pi * x);
    return s * s * y * y * (y - 1);
  }
  void set() {
    const auto n = static_cast<double>(g.cells[0]);
    for (size_t j = 0; j <= g.cells[1]; ++j) {
      for (size_t i = 0; i <= g.cells[0]; ++i)
        psi[g.at(i, j, 0)] = stream(static_cast<double>(i) / n, static_cast<double>(j) / n);
    }
  }
};

TEST(StreamFunction, HasNoDivergenceAndSeesNoGradient) {
  Plane p(12);
  for (size_t j = 0; j <= 12; ++j) {
    for (size_t i = 0; i <= 12; ++i) p.psi[p.g.at(i, j, 0)] = std::sin(5.0 * double(i) + 3.0 * double(j * j));
  }
  velocity_of_stream(p.g, p.psi.data(), p.fields(), p.arena);
  divergence(p.g, p.known(), p.out.data(), p.arena);
  for (size_t j = 0; j < 12; ++j) {
    for (size_t i = 0; i < 12; ++i) EXPECT_NEAR(p.out[p.g.at(i, j, 0)], 0, 1e-11);
  }
  // A gradient, by differences of either order, has no curl on nodes away from the sides.
  for (const bool fourth : {false, true}) {
    std::vector<double> q(p.g.size());
    for (size_t k = 0; k < q.size(); ++k) q[k] = std::cos(double(k * k % 97));
    std::fill(p.u.begin(), p.u.end(), 0.0), std::fill(p.v.begin(), p.v.end(), 0.0);
    for (size_t c = 0; c < 2; ++c) {
      double* u = c == 0 ? p.u.data() : p.v.data();
      fourth ? subtract_gradient4(p.g, c, q.data(), 1, u, p.arena)
             : subtract_gradient(p.g, c, q.data(), 1, u, p.arena);
    }
    fourth ? curl_of_rate4(p.g, p.known(), p.out.data(), p.arena)
           : curl_of_rate(p.g, p.known(), p.out.data(), p.arena);
    for (size_t j = 3; j < 9; ++j) {
      for (size_t i = 3; i < 9; ++i) EXPECT_NEAR(p.out[p.g.at(i, j, 0)], 0, 1e-10) << fourth;
    }
    // Control: a rotating flow has one.
    for (size_t j = 0; j <= 12; ++j) {
      for (size_t i = 0; i <= 12; ++i) p.u[p.g.at(i, j, 0)] = -double(j), p.v[p.g.at(i, j, 0)] = double(i);
    }
    fourth ? curl_of_rate4(p.g, p.known(), p.out.data(), p.arena)
           : curl_of_rate(p.g, p.known(), p.out.data(), p.arena);
    EXPECT_NEAR(p.out[p.g.at(5, 5, 0)], 24, 1e-10);
  }
}

// Velocities inside and beyond walls at rest (except the lid, whose velocity varies here).
TEST(StreamFunction, VelocitiesOfFourthOrderHaveItUpToTheWalls) {
  const auto error = [](size_t cells) {
    Plane p(cells);
    p.set();
    velocity_of_stream4(p.g, {}, p.psi.data(), p.fields(), p.arena);
    fill_ghosts4(p.g, 1, {}, p.v.data());
    double most = 0;
    const auto n = static_cast<double>(cells);
    for (size_t j = 0; j <= cells / 2; ++j) {
      for (size_t m = 0; m < cells + 1; ++m) {
        // From one value beyond the left wall: v = -dpsi/dx.
        const double x = (static_cast<double>(m) - 0.5) / n, y = static_cast<double>(j) / n;
        const double exact = -std::numbers::pi * std::sin(2 * std::numbers::pi * x) * y * y * (y - 1);
        most = std::max(most, std::abs(p.v[p.g.at(m, j, 0) - 1] - exact));
      }
    }
    return most;
  };
  const double coarse = error(16), fine = error(32);
  std::printf("  largest error %.1e, %.1e of 0.47 m/s\n", coarse, fine);
  // Fourth order removes 15/16; second order would leave a quarter.
  EXPECT_LT(fine, coarse / 10);
  EXPECT_GT(coarse, 1e-6) << "control: there is an error to fall";
}

}  // namespace
}  // namespace truestep::mac
