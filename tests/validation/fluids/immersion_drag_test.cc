// The drag of a thick liquid on a body: a ball that falls along a tube against Stokes' law and the tube's
// correction (Haberman, Sayre 1958; Happel, Brenner, Low Reynolds Number Hydrodynamics, 7-3).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/immersed_scenes.h"

namespace truestep {
namespace {

using namespace testing_coupled;

/// A closed tube along y as triangles about the origin; its sides are as far out as a circle's on average.
std::string tube(double radius, double half) {
  constexpr int kSides = 48;
  const double step = 2 * std::numbers::pi / kSides, out = radius / std::sqrt(std::sin(step) / step);
  std::string vertices = triple({0, -half, 0}) + ", " + triple({0, half, 0}), triangles;
  for (int k = 0; k < kSides; ++k) {
    const Vec3 rim{out * std::cos(k * step), half, -out * std::sin(k * step)};
    vertices += ", " + triple({rim.x, -half, rim.z}) + ", " + triple(rim);
    const int low = 2 + 2 * k, next = 2 + 2 * ((k + 1) % kSides);
    for (const int v : {0, next, low, 1, low + 1, next + 1, low, next, low + 1, next, next + 1, low + 1}) {
      triangles += (triangles.empty() ? "" : ", ") + std::to_string(v);
    }
  }
  return R"("vertices": [)" + vertices + R"(], "triangles": [)" + triangles + "]";
}

constexpr double kRadius = 0.1, kTube = 0.3, kViscosity = 0.1;

/// m/s, means over a fifth of a second and the next, of the fall of a ball twice as dense as the
/// liquid. Over a tenth of a second its speed swings by a quarter, with the liquid's pressure.
struct Fall {
  double before, speed;
};
Fall fall(const std::string& walls) {
  Bath bath;
  bath.size = {0.7, 1, 0.7}, bath.depth = 0.9, bath.dt = 0.005;
  bath.body = R"("type": "sphere", "radius": 0.1, "position": [0.35, 0.55, 0.35], "density": 2000)";
  bath.hollow = R"("shape": "ball", "center": [0.35, 0.55, 0.35], "radius": 0.1)";
  bath.water = R"(, "xsph": 0, "viscosity": )" + number(kViscosity) + R"(, "walls": ")" + walls +
               R"(", "colliders": [{"type": "mesh", "container": true, "center": [0.35, 0.5, 0.35], )" +
               tube(kTube, 0.6) + "}]";
  SceneRun run(bath.scene());
  const auto after = [&](int steps) {
    const double from = body_height(run);
    EXPECT_EQ(run.session.step(static_cast<uint64_t>(steps)), static_cast<uint64_t>(steps));
    return (from - body_height(run)) / (steps * bath.dt);
  };
  after(40);
  const double before = after(40);
  return {before, after(40)};
}

// At four spacings a radius the liquid sees a ball an eighth of a spacing larger in a tube as much narrower:
// less weight in it, more drag and more of it by the tube, together 17 %; a sixth of a spacing makes 23 %.
TEST(ImmersionDrag, ABallFallsAlongATubeAtItsTerminalSpeed) {
  const double l = kRadius / kTube, l3 = l * l * l, l5 = l3 * l * l;
  const double stokes = 2.0 / 9 * 9.81 * kRadius * kRadius / kViscosity;
  const double wall = (1 - 0.75857 * l5) / (1 - 2.1050 * l + 2.0865 * l3 - 1.7068 * l5 + 0.72603 * l5 * l);
  const Fall f = fall("no_slip");
  std::printf("falls at %.4f m/s (%.4f before), Stokes %.4f / %.3f = %.4f m/s\n", f.speed, f.before, stokes,
              wall, stokes / wall);
  EXPECT_NEAR(f.speed, f.before, 0.1 * f.speed) << "it is terminal";
  EXPECT_GT(f.speed, 0.77 * stokes / wall);
  EXPECT_LT(f.speed, 1.05 * stokes / wall);
  EXPECT_GT(stokes, 1.5 * f.speed) << "control: without the tube";
  EXPECT_GT(fall("slip").speed, 1.3 * f.speed) << "control: a ball and a tube that do not hold the liquid";
}

}  // namespace
}  // namespace truestep
