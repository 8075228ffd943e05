// Shots of all shapes, speeds and directions do not tunnel through thin walls in the plane.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "tests/support/runs/rigid2d_run.h"

namespace truestep {
namespace {

using Trial = testing::FlatTrial;

TEST(Rigid2dStability, NoShotPassesAThinWall) {
  // A ball of 0.1 m at 300 m/s against walls of 1 cm: 5 m in a step of 1/60 s.
  int through = 0;
  for (uint64_t k = 0; k < 4000; ++k) {
    const auto u = uniform4(3, 1, k), v = uniform4(3, 2, k);
    const std::string speed = std::to_string(50 + 250 * u[0]), y = std::to_string(-1.5 + 3 * u[1]);
    const char* shape =
        v[0] < 0.33   ? R"({"type": "circle", "radius": 0.1})"
        : v[0] < 0.66 ? R"({"type": "box", "half_extents": [0.1, 0.03, 0]})"
                      : R"({"type": "capsule", "from": [-0.1, 0, 0], "to": [0.1, 0, 0], "radius": 0.02})";
    Trial t(R"("gravity": [0, 0, 0], "bodies": [
      {"motion": "fixed", "position": [0, 0, 0], "angle": )" +
            std::to_string(u[2] - 0.5) + R"(, "shapes": [{"type": "box", "half_extents": [0.005, 5, 0]}]},
      {"position": [)" +
            std::to_string(-3 - 4 * u[3]) + ", " + y + R"(, 0], "velocity": [)" + speed +
            R"(, 0, 0], "angle": )" + std::to_string(6 * v[1]) + R"(, "angular_velocity": )" +
            std::to_string(40 * v[2] - 20) + R"(, "shapes": [)" + shape + "]}]");
    const Vec3 normal{std::cos(u[2] - 0.5), std::sin(u[2] - 0.5), 0};
    bool passed = false;
    for (int step = 0; step < 6; ++step) {
      t.steps(1);
      const double depth = dot(normal, t.position(1));
      // A shot that slides off over the wall's rim did not pass through it.
      passed |= depth > 0 && norm(t.position(1) - normal * depth) < 4.8;
    }
    through += passed;
  }
  EXPECT_EQ(through, 0);
}

}  // namespace
}  // namespace truestep
