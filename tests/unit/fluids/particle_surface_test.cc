// The surface of a liquid of particles: closed, with the liquid's volume, and flat where the liquid is flat.
#include "engine/geometry/particle_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "engine/math/vec3.h"

namespace truestep {
namespace {

constexpr double kSpacing = 0.1;

Vec3 vertex(const ParticleSurface& s, size_t i) {
  return {double{s.positions[3 * i]}, double{s.positions[3 * i + 1]}, double{s.positions[3 * i + 2]}};
}
double volume(const ParticleSurface& s) {
  double sum = 0;
  for (size_t t = 0; t < s.triangles.size(); t += 3) {
    sum +=
        dot(vertex(s, s.triangles[t]), cross(vertex(s, s.triangles[t + 1]), vertex(s, s.triangles[t + 2]))) /
        6;
  }
  return sum;
}
bool closed(const ParticleSurface& s) {
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (size_t t = 0; t < s.triangles.size(); ++t) {
    ++edges[{s.triangles[t], s.triangles[t % 3 == 2 ? t - 2 : t + 1]}];
  }
  for (const auto& [edge, times] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (times != 1 || back == edges.end() || back->second != 1) return false;
  }
  return !edges.empty();
}

/// Lattice points within a shape, each displaced by up to `shake` spacings along every axis.
template <class Inside>
std::vector<float> lattice(int reach, double shake, const Inside& inside) {
  std::mt19937 random(3);
  const auto off = [&] { return shake * (2 * (random() / 4294967296.0) - 1); };
  std::vector<float> out;
  for (int i = -reach; i < reach; ++i) {
    for (int j = -reach; j < reach; ++j) {
      for (int k = -reach; k < reach; ++k) {
        const Vec3 x = Vec3{i + 0.5, j + 0.5, k + 0.5} * kSpacing;
        if (!inside(x)) continue;
        const Vec3 p = x + Vec3{off(), off(), off()} * kSpacing;
        for (const double c : {p.x, p.y, p.z}) out.push_back(static_cast<float>(c));
      }
    }
  }
  return out;
}

TEST(ParticleSurface, OfABallIsABall) {
  constexpr double kRadius = 0.8;
  const auto x = lattice(9, 0, [](const Vec3& p) { return norm(p) < kRadius; });
  const std::vector<float> ones(x.size() / 3, 7);
  const ParticleSurface s = particle_surface(x, ones, {kSpacing, 0.5 * kSpacing});
  EXPECT_TRUE(closed(s));
  // A tenth of a spacing all around is 4 % of the volume.
  const double own = static_cast<double>(x.size()) / 3 * kSpacing * kSpacing * kSpacing;
  EXPECT_NEAR(volume(s), own, 0.05 * own);
  for (size_t i = 0; i < s.positions.size() / 3; ++i) {
    // The lattice's own spacing limits the accuracy.
    EXPECT_NEAR(norm(vertex(s, i)), kRadius, 0.7 * kSpacing);
    EXPECT_NEAR(s.values[i], 7, 1e-4);
  }
  const ParticleSurface half = particle_surface(x, {}, {0.8 * kSpacing, 0.5 * kSpacing});
  EXPECT_LT(volume(half), 0.9 * own) << "control: particles of half the volume";
}

// Half a spacing above the uppermost particles; displacing these hardly shows.
TEST(ParticleSurface, OfStillWaterIsFlat) {
  const auto ripple = [&](double shake, double bump) {
    const auto x = lattice(10, shake, [&](const Vec3& p) {
      return p.y < (norm(p - Vec3{0, p.y, 0}) < 0.25 ? bump : 0);
    });
    const ParticleSurface s = particle_surface(x, {}, {kSpacing, 0.5 * kSpacing});
    double sum = 0, squares = 0, n = 0;
    for (size_t i = 0; i < s.positions.size() / 3; ++i) {
      const Vec3 p = vertex(s, i);
      // Away from the sides: a kernel's reach.
      if (p.y < -0.5 || std::abs(p.x) > 0.6 || std::abs(p.z) > 0.6) continue;
      sum += p.y, squares += p.y * p.y, n += 1;
    }
    EXPECT_GT(n, 100);
    if (bump == 0) {
      EXPECT_NEAR(sum / n, 0, 0.15 * kSpacing);
    }
    return std::sqrt(std::max(squares / n - sum / n * sum / n, 0.0));
  };
  EXPECT_LT(ripple(0, 0), 0.03 * kSpacing);
  // The particles themselves are displaced by 0.14 spacings (rms).
  EXPECT_LT(ripple(0.25, 0), 0.1 * kSpacing);
  EXPECT_GT(ripple(0, 2 * kSpacing), 0.3 * kSpacing) << "control: a bump of two layers";
}

TEST(ParticleSurface, OfADropIsItsOwnSize) {
  const std::vector<float> x{1, 2, 3};
  const ParticleSurface s = particle_surface(x, {}, {kSpacing, 0.1 * kSpacing, 8'000'000, 0});
  EXPECT_TRUE(closed(s));
  for (size_t i = 0; i < s.positions.size() / 3; ++i) {
    EXPECT_NEAR(norm(vertex(s, i) - Vec3{1, 2, 3}), 0.5 * kSpacing, 0.1 * kSpacing);
  }
}

TEST(ParticleSurface, TakesWhateverThereIs) {
  EXPECT_TRUE(particle_surface({}, {}, {kSpacing, kSpacing}).triangles.empty());
  const std::vector<float> x{0, 0, 0, NAN, 0, 0, 0, INFINITY, 0, 3e38f, -3e38f, 0};
  EXPECT_TRUE(particle_surface(x, {}, {0, kSpacing}).triangles.empty());
  // The lattice becomes as coarse as its limit demands.
  particle_surface(x, {}, {kSpacing, 0.5 * kSpacing, 100'000});
  const std::vector<float> far{0, 0, 0, 1e4f, 0, 0};
  EXPECT_LE(particle_surface(far, {}, {kSpacing, 0.5 * kSpacing, 100'000}).positions.size(), 300'000u);
}

}  // namespace
}  // namespace truestep
