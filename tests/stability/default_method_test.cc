// The default of a scene that names no method: one that holds at the scene's own step, with the reason in the
// plan.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/core/equations/force_system.h"
#include "tests/support/world_run.h"

namespace truestep {
namespace {

struct MethodRun : testing_rig::WorldRun {
  explicit MethodRun(const std::string& system, double dt, const std::string& more = "")
      : WorldRun(R"({"schema_version": "1.0", )" + more + R"( "time": {"dt": )" + std::to_string(dt) +
                 R"(}, "systems": [)" + system + "]}") {}
  std::string method() const {
    return std::string(dynamic_cast<const ForceSystem&>(world.system(0)).integrator().name);
  }
  std::string reason() const {
    for (const auto& [system, row, number] : world.plan()) {
      if (row.name == "integrate") return row.reason;
    }
    return "";
  }
};

std::string oscillator(double stiffness, const std::string& rest = "") {
  return R"({"type": "oscillator", "id": "o", "mass": 1, "position": 1, "stiffness": )" +
         std::to_string(stiffness) + rest + "}";
}

TEST(DefaultMethod, FollowsTheFastestMotionAgainstTheStep) {
  EXPECT_EQ(MethodRun(oscillator(100), 0.01).method(), "rk4");
  EXPECT_EQ(MethodRun(oscillator(1e6), 0.01).method(), "dop853");
  EXPECT_EQ(MethodRun(oscillator(1e10), 0.01).method(), "bdf2");
  // The step decides, not the spring.
  EXPECT_EQ(MethodRun(oscillator(1e10), 1e-5).method(), "rk4");
  EXPECT_NE(MethodRun(oscillator(1e10), 0.01).reason().find("too fast for rk4"), std::string::npos);
  for (const double k : {100.0, 1e6, 1e10}) {
    MethodRun run(oscillator(k), 0.01);
    EXPECT_LE(run.steps(500).observed("energy.total"), 0.5 * k * (1 + 1e-6)) << k;
  }
}

TEST(DefaultMethod, HoldsShortPendulumsAndStiffPairsOfParticles) {
  MethodRun pendulum(R"({"type": "pendulum", "id": "p", "links": 3, "length": 1e-4, "angle": 0.3})",
                     1.0 / 60);
  EXPECT_EQ(pendulum.method(), "dop853") << pendulum.reason();
  const double start = pendulum.observed("energy.total");
  EXPECT_NEAR(pendulum.steps(300).observed("energy.total"), start, 1e-3 * std::abs(start));
  MethodRun pair(R"({"type": "particles", "id": "p", "mass": 1, "positions": [[0, 0, 0], [1.001, 0, 0]],
               "springs": [{"a": 0, "b": 1, "stiffness": 1e8, "rest_length": 1}]})",
                 0.01, R"("gravity": [0, 0, 0],)");
  EXPECT_NE(pair.method(), "leapfrog");
  EXPECT_LE(pair.steps(500).observed("energy.total"), 50 * (1 + 1e-3));
}

TEST(DefaultMethod, NeverReplacesOneThatIsNamed) {
  MethodRun run(oscillator(1e10, R"(, "integrator": "rk4")"), 0.01);
  EXPECT_EQ(run.method(), "rk4");
  EXPECT_NE(run.reason().find("named by the scene"), std::string::npos);
  EXPECT_THROW(run.steps(500), Instability) << "control: it does not hold";
}

// A beam of 200 links with springs in its hinges, clamped at one end. Bending stiffness EI, mass per length
// rho: a spring of EI / l between links of length l, twice that at the clamp (half a link bends there).
constexpr int kLinks = 200;
std::string beam(double EI, const std::string& joint = "hinge", const std::string& rest = "") {
  const double l = 1.0 / kLinks;
  const auto link = [&](double stiffness, const std::string& more) {
    return R"({"joint": ")" + joint + R"(", "mass": )" + std::to_string(l) + R"(, "center": [)" +
           std::to_string(l / 2) + R"(, 0, 0], "inertia": [1e-9, 1e-7, 1e-7], "stiffness": )" +
           std::to_string(stiffness) + more + "}";
  };
  return R"({"type": "articulation", "id": "beam", "links": [)" + link(2 * EI / l, "") + ", " +
         link(EI / l, R"(, "offset": [)" + std::to_string(l) + R"(, 0, 0], "copies": {"count": )" +
                          std::to_string(kLinks - 1) + R"(, "offset": [)" + std::to_string(l) + ", 0, 0]}") +
         "]" + rest + "}";
}
constexpr const char* kLight = R"("gravity": [0, -0.1, 0],)";

// That they swing like beams and hold is in tests/scenes/chains.
TEST(DefaultMethod, OfABeamOfTwoHundredLinks) {
  MethodRun run(beam(std::pow(2 * std::numbers::pi / 3.5160152685, 2)), 1.0 / 60, kLight);
  EXPECT_EQ(run.method(), "bdf2") << run.reason();
}

TEST(DefaultMethod, OfFewStiffLinks) {
  MethodRun run(R"({"type": "articulation", "id": "a", "links": [
        {"joint": "ball", "shapes": [{"type": "box", "half_extents": [0.2, 0.05, 0.08], "position": [0.2, 0, 0]}]},
        {"joint": "hinge", "axis": [0, 0, 1], "offset": [0.4, 0, 0], "stiffness": 3e7,
         "shapes": [{"type": "box", "half_extents": [0.2, 0.05, 0.08], "position": [0.2, 0, 0]}]},
        {"joint": "universal", "axis": [0, 0, 1], "second_axis": [0, 1, 0], "offset": [0.4, 0, 0],
         "stiffness": 1e7,
         "shapes": [{"type": "box", "half_extents": [0.2, 0.05, 0.08], "position": [0.2, 0, 0]}]}]})",
                1.0 / 60);
  EXPECT_EQ(run.method(), "radau5") << run.reason();
}

std::string rope(double stiffness) {
  return R"({"type": "mass_spring", "id": "r", "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 40},
             "pinned": ["first"], "mass": 0.01, "stiffness": )" +
         std::to_string(stiffness) + "}";
}

TEST(DefaultMethod, OfTheStiffestRope) {
  for (const double k : {1e10, 1e12}) {
    MethodRun run(rope(k), 1.0 / 60);
    EXPECT_EQ(run.method(), "implicit_euler") << run.reason();
  }
}

}  // namespace
}  // namespace truestep
