// Crowds that hit a light cloth all at once used to leak through it: the answers of a step lost the paths
// before them, and a fast rotating triangle was met too late. Now nothing passes, at any speed.
// (Momenta and energy are in tests/scenes/couplings/crowd_and_free_cloth_gain_nothing.json.)
#include <cmath>

#include "engine/base/random.h"
#include "engine/kernels/contact/straight_contact.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

Vec3 random_vec(uint64_t stream, uint64_t i) {
  const auto u = uniform4(17, stream, i);
  return {2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
}

// The triangle's straight motion, sampled: nothing comes within the target before the contact that is found,
// or at all if none is.
TEST(StraightContact, AgreesWithDenseSampling) {
  int hits = 0, late = 0;
  for (uint64_t i = 0; i < 3000; ++i) {
    const bool fast = i % 2;
    std::array<HullPath, 3> c;
    for (uint64_t k = 0; k < 3; ++k)
      c[k] = {random_vec(10 + k, i), random_vec(20 + k, i) * (fast ? 6 : 1), {}};
    const HullPath p{random_vec(4, i), random_vec(5, i) * 2, {}};
    const double target = i % 3 ? 1e-9 : 0.01;
    const auto apart = [&](double s) {
      std::array<Vec3, 3> at;
      for (size_t k = 0; k < 3; ++k) at[k] = c[k].at(s);
      return norm(p.at(s) - blend(at, nearest_on_hull(p.at(s), at, 3), 3));
    };
    if (apart(0) <= 2 * target) continue;
    const auto hit = first_straight_contact(p, c, target);
    constexpr int kSamples = 2000;
    for (int k = 0; k <= (hit ? hit->s : 1) * kSamples; ++k) {
      ASSERT_GE(apart(double(k) / kSamples), target * (1 - 1e-6)) << i;
    }
    if (!hit) continue;
    ++hits;
    EXPECT_LE(hit->apart, std::max(2 * target, 1e-6)) << i;
    // The control: with one direction at a time, some contacts are not found within as many advances.
    late += !first_hull_contact(p, c, 3, target);
  }
  EXPECT_GT(hits, 200);
  EXPECT_GT(late, 5);
}

TEST(StraightContact, CubicFallsAtItsFirstRoot) {
  for (uint64_t i = 0; i < 2000; ++i) {
    const auto u = uniform4(3, 1, i);
    const double c0 = 0.1 + u[0], c1 = 8 * u[1] - 4, c2 = 16 * u[2] - 8, c3 = 16 * u[3] - 8;
    const auto value = [&](double t) { return c0 + t * (c1 + t * (c2 + t * c3)); };
    const double first = first_fall_of_cubic(c0, c1, c2, c3, 1);
    for (double t = 0; t <= std::min(first, 1.0); t += 1e-3) ASSERT_GE(value(t), 0) << i << " at " << t;
    if (first <= 1) {
      EXPECT_NEAR(value(first), 0, 1e-12) << i;
    }
  }
}

/// Number of points under the cloth: those with an odd number of its triangles straight above them.
int below(const SceneRun& run) {
  const ConstPoints c(run.session.state().systems[0], *run.world->system(0).ports().points);
  const ConstPoints p(run.session.state().systems[1], *run.world->system(1).ports().points);
  int count = 0;
  for (size_t i = 0; i < p.count; ++i) {
    const Vec3 x = load3(p.x, i);
    bool under = false;
    for (const auto& t : run.world->system(0).ports().solids.triangles) {
      const Vec3 a = load3(c.x, t[0]) - x, b = load3(c.x, t[1]) - x, d = load3(c.x, t[2]) - x;
      const auto turn = [](const Vec3& u, const Vec3& v) { return u.x * v.z - u.z * v.x; };
      const double wd = turn(a, b), wa = turn(b, d), wb = turn(d, a);
      if ((wa < 0) != (wb < 0) || (wb < 0) != (wd < 0)) continue;
      under ^= (wa * a.y + wb * b.y + wd * d.y) / (wa + wb + wd) > 0;
    }
    count += under;
  }
  return count;
}

struct Crowd {
  double speed, dt, mass, node_mass, thickness;
  int count, seed;
};

std::string scene(const Crowd& k, const char* coupling) {
  char text[1024];
  std::snprintf(text, sizeof text, R"({"seed": %d, "time": {"dt": %g}, "systems": [
      {"type": "mass_spring", "id": "cloth", "cloth_grid": {"nx": 12, "ny": 12}, "mass": %g, "stiffness": 400,
       "pinned": ["border"], "internal_damping": 0.5, "thickness": %g},
      {"type": "particles", "id": "dust", "mass": %g, "fill": [{"count": %d, "arrangement": "random",
       "center": [0.5, 0.6, 0.5], "half_extents": [0.25, 0.4, 0.25], "velocity": [0, %g, 0]}]}],
    "couplings": [%s]})",
                k.seed, k.dt, k.node_mass, k.thickness, k.mass, k.count, -k.speed, coupling);
  return text;
}

constexpr const char* kContact =
    R"({"type": "contact", "id": "c", "a": "dust", "b": "cloth", "restitution": 0.2, "friction": 0.8})";

int most_below(const Crowd& crowd, const char* coupling) {
  SceneRun run(scene(crowd, coupling));
  int most = 0;
  // Until the cloth has thrown the crowd back; later some fly over its edge and fall beside it.
  for (double t = 0; t < 0.25; t += crowd.dt) {
    run.session.step(1);
    most = std::max(most, below(run));
  }
  return most;
}

TEST(CrowdOnCloth, NothingPassesAt20MetresPerSecond) {
  for (int seed = 0; seed < 5; ++seed) {
    const Crowd crowd{.speed = 20,
                      .dt = 0.008,
                      .mass = 0.01,
                      .node_mass = 0.05,
                      .thickness = 0.02,
                      .count = 300,
                      .seed = seed};
    EXPECT_EQ(most_below(crowd, kContact), 0) << seed;
    // The control: without the coupling the same count finds them all below.
    EXPECT_GT(most_below(crowd, ""), 290) << seed;
  }
}

TEST(CrowdOnCloth, NorMuchHarder) {
  const Crowd usual{
      .speed = 20, .dt = 0.008, .mass = 0.01, .node_mass = 0.05, .thickness = 0.02, .count = 300, .seed = 0};
  Crowd fast = usual, light = usual, thin = usual, many = usual, coarse = usual, bullet = usual;
  fast.speed = 200;
  light.node_mass = 0.005;
  thin.thickness = 0;
  many.count = 1500;
  coarse.dt = 0.02;
  bullet.speed = 800, bullet.count = 3;
  for (const Crowd& crowd : {fast, light, thin, many, coarse, bullet}) {
    EXPECT_EQ(most_below(crowd, kContact), 0) << crowd.speed << ' ' << crowd.node_mass << ' ' << crowd.count;
  }
}

}  // namespace
}  // namespace truestep
