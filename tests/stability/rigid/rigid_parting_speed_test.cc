// A hundred balls at one place used to fly apart at 90 m/s: each pair was pushed apart at push_out_speed, the
// pushes of all pairs accumulated in every body, and what a sweep did not take back remained as velocity.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/random.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

struct Cluster {
  int dimensions = 3;
  const char* precision = "f32";
  const char* shape = "ball";
  double spread = 0;  ///< m, of the places
  enum class Masses : uint8_t { equal, mixed } masses = Masses::equal;
  int substeps = 0;  ///< 0: the default
};

struct Fastest {
  double motion = 0, speed = 0;  ///< m/s: from a body's motion in a step, and from its velocity
};

/// A hundred bodies of half a metre and nothing else, for half a second.
Fastest part(const Cluster& c) {
  const bool flat = c.dimensions == 2, ball = std::string(c.shape) == "ball";
  std::string bodies;
  for (uint64_t k = 0; k < 100; ++k) {
    const auto u = uniform4(5, static_cast<uint64_t>(c.dimensions), k);
    const auto at = [&](size_t axis) { return std::to_string(c.spread * (u[axis] - 0.5)); };
    const std::string size = ball ? R"("radius": 0.5)" : R"("half_extents": [0.5, 0.4, 0.3])";
    const std::string density =
        std::to_string(c.masses == Cluster::Masses::equal ? 1000 : std::pow(10, 1 + 3 * u[3]));
    bodies +=
        std::string(k ? ", " : "") + R"({"position": [)" + at(0) + ", " + at(1) + ", " +
        (flat ? "0" : at(2)) + R"(], "density": )" + density + ", " +
        (flat ? R"("shapes": [{"type": ")" + std::string(ball ? "circle" : "box") + "\", " + size + "}]}"
              : R"("type": ")" + std::string(ball ? "sphere" : "box") + "\", " + size + "}");
  }
  World world(parse_scene(R"({"time": {"dt": 0.016666666666666666}, "systems": [{"id": "r", "type": "rigid)" +
                          std::to_string(c.dimensions) + R"(d", "gravity": [0, 0, 0], "precision": ")" +
                          c.precision + "\"" +
                          (c.substeps ? ", \"substeps\": " + std::to_string(c.substeps) : "") +
                          R"(, "bodies": [)" + bodies + "]}]}"));
  WorldState state = world.initial_state();
  Workspace workspace;
  ThreadArena arena{1};
  State& s = state.systems[0];
  Fastest most;
  for (int k = 0; k < 30; ++k) {
    const auto x = s.f64(s.at("position"));
    const std::vector<double> before(x.begin(), x.end());
    world.step(state, workspace, arena, {});
    for (size_t i = 0; i < 100; ++i) {
      const Vec3 moved = load3(s.f64(s.at("position")).data(), i) - load3(before.data(), i);
      most.motion = std::max(most.motion, 60 * norm(moved));
      most.speed = std::max(most.speed, norm(load3(s.f64(s.at("velocity")).data(), i)));
    }
  }
  return most;
}

TEST(RigidPartingSpeed, IsAtMostPushOutSpeedHoweverManyOverlap) {
  for (const int dimensions : {2, 3}) {
    for (const char* precision : {"f32", "f64"}) {
      for (const char* shape : {"ball", "box"}) {
        for (const double spread : {0.0, 0.3}) {
          // For slow pairs, one combination of each kind is enough.
          if (std::string(shape) == "box" && std::string(precision) == "f64") continue;
          for (const auto masses : {Cluster::Masses::equal, Cluster::Masses::mixed}) {
            const Fastest most = part({dimensions, precision, shape, spread, masses});
            // Light bodies are squeezed out sideways between heavy ones, faster than those move.
            EXPECT_LE(most.motion, masses == Cluster::Masses::equal ? 3 : 1.25 * 3)
                << dimensions << " " << precision << " " << shape << " " << spread;
            // The last push may be so gentle that its velocity is left to the relaxation.
            EXPECT_LE(most.speed, 3.0 / 32)
                << dimensions << " " << precision << " " << shape << " " << spread;
            // The control: they do separate.
            EXPECT_GT(most.motion, 0.3);
          }
        }
      }
    }
  }
}

// With an even number of substeps, rounding used to grow to 600 m/s in 24 steps, in doubles in 48.
TEST(RigidPartingSpeed, IsAtMostPushOutSpeedForAnyNumberOfSubsteps) {
  for (const int dimensions : {2, 3}) {
    for (const int substeps : {1, 2, 4, 6, 8, 16}) {
      for (const double spread : {0.0, 0.3}) {
        Cluster c{.dimensions = dimensions, .spread = spread};
        c.substeps = substeps;
        const Fastest most = part(c);
        EXPECT_LE(most.motion, 3) << dimensions << " " << substeps << " " << spread;
        EXPECT_LE(most.speed, 3.0 / 32) << dimensions << " " << substeps << " " << spread;
        EXPECT_GT(most.motion, 0.3);
      }
    }
  }
}

}  // namespace
}  // namespace truestep
