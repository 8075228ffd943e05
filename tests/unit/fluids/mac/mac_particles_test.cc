// Transfers between particles and faces conserve mass, momentum and angular momentum, and reproduce fields.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/kernels/mac/particles.h"
#include "engine/kernels/mac/surface.h"

namespace truestep::mac {
namespace {

MacGrid grid_of(size_t dimensions) {
  MacGrid g;
  g.dimensions = dimensions;
  for (size_t a = 0; a < dimensions; ++a) g.cells[a] = 8, g.spacing[a] = 0.25;
  return g;
}

struct Particle {
  double x[3], v[3], c[3][3];
};

template <size_t D>
std::vector<Particle> scattered() {
  std::vector<Particle> out;
  for (int i = 0; i < 200; ++i) {
    Particle p{};
    for (size_t a = 0; a < D; ++a) {
      // Weyl sequences fill the middle of the box evenly.
      const double r = std::fmod(double(i + 1) * (a == 0   ? 0.6180339887
                                                  : a == 1 ? 0.7548776662
                                                           : 0.5698402910),
                                 1.0);
      p.x[a] = 2 + 4 * r, p.v[a] = std::sin(7.0 * i + double(a));
      for (size_t b = 0; b < D; ++b) p.c[a][b] = std::cos(3.0 * i + double(2 * a + b));
    }
    out.push_back(p);
  }
  return out;
}

template <size_t D>
void check_transfers() {
  const MacGrid g = grid_of(D);
  std::vector<Particle> all = scattered<D>();
  // The linear field of a rotation with a stretch is reproduced at every particle.
  const double turn[3][3] = {{0.3, -2, 0.5}, {1.7, 0.1, -0.4}, {-0.2, 0.6, 0.9}}, shift[3] = {1, -2, 0.5};
  for (Particle& p : all) {
    for (size_t c = 0; c < D; ++c) {
      p.v[c] = shift[c];
      for (size_t a = 0; a < D; ++a) p.v[c] += turn[c][a] * p.x[a] * g.spacing[a], p.c[c][a] = turn[c][a];
    }
  }
  double worst = 0, worst_flat = 0;
  for (size_t c = 0; c < D; ++c) {
    std::vector<double> mass(g.size()), u(g.size()), flat_mass(g.size()), flat(g.size());
    for (const Particle& p : all) {
      const auto around = around_particle<D>(g, c, p.x);
      scatter<D>(g, around, p.v[c], p.c[c], mass.data(), u.data());
      scatter<D>(g, around, p.v[c], nullptr, flat_mass.data(), flat.data());
    }
    for (size_t i = 0; i < u.size(); ++i) {
      if (mass[i] > 0) u[i] /= mass[i], flat[i] /= flat_mass[i];
    }
    for (const Particle& p : all) {
      const auto around = around_particle<D>(g, c, p.x);
      double slope[3] = {};
      gather_slopes<D>(g, around, u.data(), slope);
      worst = std::max(worst, std::abs(gather<D>(g, around, u.data()) - p.v[c]));
      for (size_t a = 0; a < D; ++a) worst = std::max(worst, std::abs(slope[a] - turn[c][a]));
      worst_flat = std::max(worst_flat, std::abs(gather<D>(g, around, flat.data()) - p.v[c]));
    }
  }
  EXPECT_LT(worst, 1e-12) << "rounding of some hundred sums";
  EXPECT_GT(worst_flat, 0.01) << "control: without slopes (PIC) a turn is smeared";
}

TEST(MacParticles, ALinearFieldComesBackFromTheFaces) {
  check_transfers<2>();
  check_transfers<3>();
}

// Jiang et al. 2015, section 5.3 and theorem 5.2: sum over faces of m_i (x_i cross e_c u_i) is that of the
// particles with their slopes, for any velocities.
TEST(MacParticles, AngularMomentumIsKept) {
  constexpr size_t kD = 2;
  const MacGrid g = grid_of(kD);
  const std::vector<Particle> all = scattered<kD>();
  double before = 0, on_grid = 0, after = 0, flat = 0;
  std::vector<double> mass[kD], u[kD];
  for (size_t c = 0; c < kD; ++c) mass[c].resize(g.size()), u[c].resize(g.size());
  for (const Particle& p : all) {
    for (size_t c = 0; c < kD; ++c) {
      std::vector<double> m(g.size()), q(g.size());
      const auto around = around_particle<kD>(g, c, p.x);
      scatter<kD>(g, around, p.v[c], p.c[c], mass[c].data(), u[c].data());
      // The particle's own angular momentum is that of what it transfers.
      scatter<kD>(g, around, p.v[c], p.c[c], m.data(), q.data());
      for (size_t j = 0; j < g.padded(1); ++j) {
        for (size_t i = 0; i < g.padded(0); ++i) {
          const size_t at = i + g.stride(1) * j;
          const double x = g.coordinate(c, 0, double(i) - kGhosts),
                       y = g.coordinate(c, 1, double(j) - kGhosts);
          before += c == 0 ? -y * q[at] : x * q[at];
        }
      }
      flat += c == 0 ? -p.x[1] * g.spacing[1] * p.v[0] : p.x[0] * g.spacing[0] * p.v[1];
    }
  }
  for (size_t c = 0; c < kD; ++c) {
    for (size_t j = 0; j < g.padded(1); ++j) {
      for (size_t i = 0; i < g.padded(0); ++i) {
        const size_t at = i + g.stride(1) * j;
        const double x = g.coordinate(c, 0, double(i) - kGhosts), y = g.coordinate(c, 1, double(j) - kGhosts);
        on_grid += c == 0 ? -y * u[c][at] : x * u[c][at];
        if (mass[c][at] > 0) u[c][at] /= mass[c][at];
      }
    }
  }
  for (const Particle& p : all) {
    for (size_t c = 0; c < kD; ++c) {
      const auto around = around_particle<kD>(g, c, p.x);
      double slope[2];
      gather_slopes<kD>(g, around, u[c].data(), slope);
      std::vector<double> m(g.size()), q(g.size());
      scatter<kD>(g, around, gather<kD>(g, around, u[c].data()), slope, m.data(), q.data());
      for (size_t j = 0; j < g.padded(1); ++j) {
        for (size_t i = 0; i < g.padded(0); ++i) {
          const size_t at = i + g.stride(1) * j;
          const double x = g.coordinate(c, 0, double(i) - kGhosts),
                       y = g.coordinate(c, 1, double(j) - kGhosts);
          after += c == 0 ? -y * q[at] : x * q[at];
        }
      }
    }
  }
  EXPECT_NEAR(on_grid, before, 1e-11 * std::abs(before) + 1e-11);
  EXPECT_NEAR(after, before, 1e-11 * std::abs(before) + 1e-11) << "rounding";
  EXPECT_GT(std::abs(flat - before), 1e-3 * std::abs(before)) << "control: slopes carry some of it";
}

TEST(MacSurface, DepthOfFillIsTheDepthOfALevelSurface) {
  // Integral of the linear weight below a surface `depth` cells above the centre.
  for (const double depth : {-0.9, -0.4, 0.0, 0.3, 0.8}) {
    const double low = std::min(depth, 0.0), high = std::max(depth, 0.0);
    const double fill = 0.5 * (1 + low) * (1 + low) + (high - 0.5 * high * high);
    EXPECT_NEAR(depth_of_fill(fill), depth, 1e-14);
  }
  EXPECT_EQ(depth_of_fill(0), -1);
  EXPECT_EQ(depth_of_fill(1.3), 1);
  EXPECT_DOUBLE_EQ(surface_factor(0.25, -0.75), 4);
  EXPECT_DOUBLE_EQ(surface_factor(1e-9, -1), 1e6) << "bounded";
}

TEST(MacSurface, FacesBeyondTheKnownTakeTheirNeighboursMean) {
  const MacGrid g = grid_of(2);
  const ThreadArena serial(1);
  std::vector<double> u(g.size(), 0), found(g.size());
  std::vector<uint8_t> known(g.size(), 0), fresh(g.size());
  u[g.at(3, 3, 0)] = 5, known[g.at(3, 3, 0)] = 1;
  extrapolate(g, 0, 2, u.data(), known.data(), found.data(), fresh.data(), serial);
  EXPECT_EQ(u[g.at(4, 3, 0)], 5);
  EXPECT_EQ(u[g.at(4, 4, 0)], 5);
  EXPECT_EQ(u[g.at(5, 3, 0)], 5);
  EXPECT_EQ(u[g.at(6, 3, 0)], 0) << "three layers away";
}

}  // namespace
}  // namespace truestep::mac
