// Momentum that the fluxes of mass of two fluids carry, and stresses where their viscosities differ.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/kernels/mac/border_momentum.h"
#include "engine/kernels/mac/ghosts.h"
#include "engine/kernels/mac/stress.h"

namespace truestep::mac {
namespace {

constexpr size_t kCells = 12;
constexpr TwoDensities kDensities{1, 1000};

struct Box {
  MacGrid g;
  Sides sides;
  std::vector<double> share, full, swelling, flux, moved;
  std::array<std::vector<double>, 2> u;
  ThreadArena arena{1};

  Box() {
    g.cells = {kCells, kCells, 1};
    g.spacing = {1.0 / kCells, 1.0 / kCells, 1};
    g.periodic = {true, true, false};
    for (size_t a = 0; a < 2; ++a) sides[a][0].mirror = sides[a][1].mirror = Mirror::periodic;
    for (auto* v : {&share, &full, &swelling, &flux, &moved, &u[0], &u[1]}) v->assign(g.size(), 0);
    for_rows(g, kCentre, arena, [&](size_t at, size_t j, size_t, size_t n) {
      for (size_t i = 0; i < n; ++i) {
        const double x = (double(i) + 0.5) / kCells - 0.5, y = (double(j) + 0.5) / kCells - 0.5;
        share[at + i] = std::clamp(0.5 + kCells * (0.3 - std::sqrt(x * x + y * y)), 0.0, 1.0);
      }
    });
  }
  void fill(size_t place, std::vector<double>& v) { fill_ghosts(g, place, sides, v.data(), arena); }
  // Both axes of a step of h, of a velocity q that u carries.
  void carry(double h, std::array<std::vector<double>, 2>& q) {
    const ConstFields speeds{u[0].data(), u[1].data(), nullptr};
    for (size_t i = 0; i < share.size(); ++i) full[i] = share[i] > 0.5, swelling[i] = 0;
    fill(kCentre, full);
    for (size_t axis = 0; axis < 2; ++axis) {
      const Sweep sweep = axis == 1 ? Sweep::last : Sweep::inner;
      fill(kCentre, share);
      share_flux(g, axis, u[axis].data(), h, share.data(), flux.data(), arena);
      moved.assign(g.size(), 0);
      carry_share(g, axis, sweep, u[axis].data(), h, share.data(), flux.data(), full.data(), swelling.data(),
                  moved.data(), arena);
      const std::vector<double> next = moved;
      mass_flux(g, axis, u[axis].data(), h, kDensities, flux.data(), arena);
      fill(axis, flux);
      for (size_t c = 0; c < 2; ++c) {
        fill(c, q[c]);
        carry_momentum(g, c, axis, sweep, speeds, h, kDensities, share.data(), full.data(), flux.data(),
                       q[c].data(), moved.data(), arena);
        for_rows(g, c, arena, [&](size_t at, size_t, size_t, size_t n) {
          std::copy_n(moved.data() + at, n, q[c].data() + at);
        });
      }
      share = next;
    }
    fill(kCentre, share);
  }
  double momentum(size_t c, const std::vector<double>& q) {
    fill(kCentre, share);
    double sum = 0;
    for_rows(g, c, arena, [&](size_t at, size_t, size_t, size_t n) {
      for (size_t i = at; i < at + n; ++i)
        sum += 0.5 * (kDensities.of(share[i]) + kDensities.of(share[i - g.stride(c)])) * q[i];
    });
    return sum;
  }
};

// A pattern without symmetry between -1 and 1.
double pattern(size_t i) {
  return std::sin(12.9898 * double(i % 97)) * std::cos(4.1414 * double(i % 31));
}

TEST(MacBorderMomentum, AVelocityThatIsTheSameEverywhereStays) {
  Box box;
  // Velocities with a divergence, as a pressure's tolerance leaves it.
  for (size_t a = 0; a < 2; ++a) {
    for (size_t i = 0; i < box.u[a].size(); ++i) box.u[a][i] = 0.5 + 0.05 * pattern(i);
    box.fill(a, box.u[a]);
  }
  std::array<std::vector<double>, 2> q;
  for (auto& v : q) v.assign(box.g.size(), 3);
  for (int k = 0; k < 5; ++k) box.carry(0.2 / kCells, q);
  for (size_t c = 0; c < 2; ++c) {
    for_rows(box.g, c, box.arena, [&](size_t at, size_t, size_t, size_t n) {
      // Ten sweeps at 1000:1.
      for (size_t i = at; i < at + n; ++i) EXPECT_NEAR(q[c][i], 3, 1e-10);
    });
  }
}

TEST(MacBorderMomentum, TheSumOfMomentumIsKeptAtAThousandToOne) {
  Box box;
  for (size_t i = 0; i < box.g.size(); ++i) box.u[0][i] = 0.7, box.u[1][i] = -0.4;
  std::array<std::vector<double>, 2> q;
  for (size_t c = 0; c < 2; ++c) {
    q[c].assign(box.g.size(), 0);
    for (size_t i = 0; i < box.g.size(); ++i) q[c][i] = pattern(i + c);
  }
  const double before[] = {box.momentum(0, q[0]), box.momentum(1, q[1])};
  double most = 0;
  for (int k = 0; k < 5; ++k) box.carry(0.4 / kCells, q);
  for (size_t c = 0; c < 2; ++c) {
    EXPECT_NEAR(box.momentum(c, q[c]), before[c], 1e-9) << "of 40,000 kg";
    for_rows(box.g, c, box.arena, [&](size_t at, size_t, size_t, size_t n) {
      for (size_t i = at; i < at + n; ++i) most = std::max(most, std::abs(q[c][i]));
    });
  }
  EXPECT_LE(most, 1) << "what is behind, or between";
  // Control: the same velocities with the masses of before.
  Box still;
  EXPECT_GT(std::abs(still.momentum(0, q[0]) - before[0]), 1e-3);
}

TEST(MacStress, IsTheLaplacianWhereTheViscosityIsTheSame) {
  // u = (x^2 y, -x y^2) has no divergence; its Laplacian is (2 y, -2 x).
  MacGrid g;
  g.cells = {6, 6, 1};
  g.spacing = {0.25, 0.5, 1};
  std::vector<double> u(g.size()), v(g.size()), fluidity(g.size(), 1 / 0.3), light(g.size(), 0.5),
      rate(g.size(), 1);
  for (size_t j = 0; j <= 6; ++j) {
    for (size_t i = 0; i <= 6; ++i) {
      const double x = g.coordinate(0, 0, double(i)), y = g.coordinate(0, 1, double(j));
      u[g.at(i, j, 0)] = x * x * y;
      const double xv = g.coordinate(1, 0, double(i)), yv = g.coordinate(1, 1, double(j));
      v[g.at(i, j, 0)] = -xv * yv * yv;
    }
  }
  add_stress(g, 0, {u.data(), v.data(), nullptr}, fluidity.data(), light.data(), 2, rate.data(),
             ThreadArena(1));
  // Quadratic functions: differences are exact.
  EXPECT_NEAR(rate[g.at(3, 3, 0)], 1 + 0.3 * 0.5 / 2 * 2 * g.coordinate(0, 1, 3), 1e-12);
}

}  // namespace
}  // namespace truestep::mac
