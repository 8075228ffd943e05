// The gallery's rotating box against an independent calculation: points that fly in steps of half a
// millisecond, with each crossing of a wall reflected by Newton's restitution and Coulomb's friction in the
// wall's frame.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "engine/base/random.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

struct Law {
  double restitution = 0.8, friction = 0.2, gravity = 9.81;
};
struct Energies {
  double kinetic, potential;
};

constexpr double kSpin = 0.9, kDuration = 6;

/// Energies of 20 kg of points after kDuration, with the box's axes rotating about z.
Energies reflected(const Law& law) {
  constexpr int kPoints = 6000, kSteps = 12000;
  constexpr double kStep = kDuration / kSteps;
  std::vector<std::array<Vec3, 2>> axes;
  for (int s = 1; s <= kSteps; ++s) {
    const double c = std::cos(kSpin * kStep * s), d = std::sin(kSpin * kStep * s);
    axes.push_back({Vec3{c, d, 0}, Vec3{-d, c, 0}});
  }
  const auto reflect = [&](Vec3& x, Vec3& v, const Vec3& axis) {
    const double level = dot(x, axis);
    if (std::abs(level) <= 1) return;
    const Vec3 n = axis * (level > 0 ? -1.0 : 1.0), wall = Vec3{-x.y, x.x, 0} * kSpin;
    x += n * (std::abs(level) - 1);
    const Vec3 w = v - wall;
    const double wn = dot(w, n);
    if (wn >= 0) return;
    const Vec3 wt = w - n * wn;
    const double grip = law.friction * (1 + law.restitution) * -wn, speed = norm(wt);
    v = wall + wt * (speed > grip ? 1 - grip / speed : 0) - n * (law.restitution * wn);
  };
  double kinetic = 0, height = 0;
  for (uint64_t i = 0; i < kPoints; ++i) {
    const auto a = uniform4(71, 1, i), b = uniform4(71, 2, i);
    Vec3 x = Vec3{a[0] - 0.5, a[1] - 0.5, a[2] - 0.5} * 1.2;
    // Uniform in a ball of 2 m/s.
    const double z = 2 * b[0] - 1, angle = 2 * 3.14159265358979323846 * b[1], flat = std::sqrt(1 - z * z);
    Vec3 v = Vec3{flat * std::cos(angle), flat * std::sin(angle), z} * (2 * std::cbrt(b[2]));
    for (int s = 0; s < kSteps; ++s) {
      x += v * kStep;
      x.y -= 0.5 * law.gravity * kStep * kStep;
      v.y -= law.gravity * kStep;
      if (x.x * x.x + x.y * x.y > 1) {
        for (const Vec3& axis : axes[static_cast<size_t>(s)]) reflect(x, v, axis);
      }
      if (std::abs(x.z) > 1) reflect(x, v, {0, 0, 1});
    }
    kinetic += 0.5 * norm2(v), height += x.y + 1.2;
  }
  return {20 * kinetic / kPoints, 20 * law.gravity * height / kPoints};
}

/// Energies of the scene after kDuration, in steps of its dt / parts.
Energies simulated(int parts) {
  std::ifstream file(TRUESTEP_SOURCE_DIR "/scenes/box_of_particles.json");
  std::stringstream text;
  text << file.rdbuf();
  boost::json::value document = parse_json(text.str());
  document.at("time").at("dt") = document.at("time").at("dt").as_double() / parts;
  const World world(parse_scene(write_json(document)));
  WorldState state = world.initial_state();
  Workspace workspace;
  const ThreadArena arena(1);
  const auto steps = static_cast<int>(std::lround(kDuration / world.dt()));
  for (int i = 0; i < steps; ++i) world.step(state, workspace, arena, {});
  const Observables o = world.observe(state);
  return {o.find("gas.energy.kinetic").value_or(-1), o.find("gas.energy.potential").value_or(-1)};
}

bool agree(const Energies& a, const Energies& b) {
  return std::abs(a.kinetic - b.kinetic) < 1.8 && std::abs(a.potential - b.potential) < 1.5;
}

// 6,000 and 20,000 independent points of some 3 mJ and 5 mJ each, which scatter by as much: 0.6 J of 60 and
// of 90 at one standard deviation; steps of half a millisecond here cost 0.2 J.
TEST(ParticlesBox, EnergiesAreThoseOfReflectedPoints) {
  const Energies engine = simulated(1);
  const Energies apart = reflected({});
  EXPECT_TRUE(agree(engine, apart)) << engine.kinetic << ' ' << apart.kinetic << "; " << engine.potential
                                    << ' ' << apart.potential;
  // Points at rest on rotating walls are carried to second order: halving the step changes 0.01 J, including
  // bounces that differ by chance. When carried in the world's frame, with velocities a step late, it was 0.8
  // J, and half of that for every halving.
  const Energies half = simulated(2);
  EXPECT_NEAR(half.kinetic, engine.kinetic, 0.1);
  EXPECT_NEAR(half.potential, engine.potential, 0.2);
  // The controls: any other law is detected.
  EXPECT_FALSE(agree(engine, reflected({.restitution = 0.7})));
  EXPECT_FALSE(agree(engine, reflected({.restitution = 0.9})));
  EXPECT_FALSE(agree(engine, reflected({.friction = 0.3})));
  EXPECT_FALSE(agree(engine, reflected({.gravity = 9.3})));
}

}  // namespace
}  // namespace truestep
