// Explicit methods near their limit: their energy swings, by no more than the watch allows for; what gains
// more is an event, although nonlinear springs keep it from growing without bound.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include "engine/core/energy_swing.h"
#include "engine/scene/json/json.h"
#include "engine/session/session.h"

namespace truestep {
namespace {

std::shared_ptr<const World> world(const std::string& system, double dt) {
  return std::make_shared<const World>(
      parse_scene(R"({"schema_version":"1.0","gravity":[0,0,0],"time":{"dt":)" + std::to_string(dt) +
                  R"(,"duration":20},"systems":[)" + system + "]}"));
}

// ---- linear: the swing of every explicit method with a limit

class EnergySwing : public ::testing::TestWithParam<const char*> {};

TEST_P(EnergySwing, IsAtMostWhatTheShareOfTheLimitAllows) {
  const ThreadArena arena(1);
  const auto at = [](double x, double v) {
    return R"({"type":"oscillator","id":"o","mass":1,"stiffness":1,"position":)" + std::to_string(x) +
           R"(,"velocity":)" + std::to_string(v) + R"(,"integrator":")" + GetParam() + "\"}";
  };
  const auto sample = world(at(1, 0), 0.01);
  const auto limit = sample->stable_dt(sample->initial_state());
  ASSERT_TRUE(limit) << "no limit: the test is about methods that have one";
  double largest = 0;
  for (const double share : {0.3, 0.6, 0.8, 0.9, 0.95, 0.98, 0.99}) {
    for (int k = 0; k < 16; ++k) {
      const double angle = std::numbers::pi * k / 16;
      const auto w = world(at(std::cos(angle), std::sin(angle)), share * *limit);
      WorldState s = w->initial_state();
      Workspace workspace;
      const double before = 0.5;
      double most = 0;
      for (int n = 0; n < 600; ++n) {
        w->step(s, workspace, arena, {});
        const Energy e = *w->system(0).energy(s.systems[0], 0, workspace, arena);
        most = std::max(most, e.kinetic + e.potential);
      }
      const double gain = (most - before) / before;
      EXPECT_LE(gain, swing_at(share)) << "share " << share << ", angle " << angle;
      largest = std::max(largest, gain);
    }
  }
  RecordProperty("largest_gain", std::to_string(largest));
}

INSTANTIATE_TEST_SUITE_P(Methods, EnergySwing,
                         ::testing::Values("symplectic_euler", "verlet", "velocity_verlet", "leapfrog",
                                           "yoshida4", "yoshida6", "yoshida8", "kahan_li8", "pefrl", "rk4"),
                         [](const auto& info) { return std::string(info.param); });

// ---- nonlinear: a mass on one spring that flies through the spring's other end

struct Flight {
  const char* method;
  const char* velocity;
};

class EnergyOfOneSpring : public ::testing::TestWithParam<Flight> {
 protected:
  /// What 20 s end with; the limit of the step is 2 / sqrt(1892) = 0.04598 s.
  static std::optional<Failure> fly(double dt) {
    const std::string system =
        R"({"type":"mass_spring","id":"s","mass":1,"pins":[0],"integrator":")" +
        std::string(GetParam().method) + R"(","free":{"points":[[0,0,0],[1.1,0,0]],"velocities":[[0,0,0],)" +
        GetParam().velocity + R"(],"springs":[{"a":0,"b":1,"rest_length":1,"stiffness":1892}]}})";
    Session s(world(system, dt), std::make_shared<const ThreadArena>(1));
    s.step(static_cast<uint64_t>(20 / dt));
    return s.failure() ? std::optional(*s.failure()) : std::nullopt;
  }
};

// Gained 120 to 300 times what was there, and the run ended as if nothing had happened.
TEST_P(EnergyOfOneSpring, FarBeyondItsBoundIsAnEvent) {
  const auto failure = fly(0.0435);  // 0.946 of the limit: 72 times what was there
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->quantity, "energy");
}

// The control: at half the step nothing is found.
TEST_P(EnergyOfOneSpring, WithinItIsNone) {
  const auto failure = fly(0.0218);
  EXPECT_FALSE(failure) << failure->detail;
}

INSTANTIATE_TEST_SUITE_P(Flights, EnergyOfOneSpring,
                         ::testing::Values(Flight{"velocity_verlet", "[10,13,0]"},
                                           Flight{"symplectic_euler", "[10,13,0]"}),
                         [](const auto& info) { return std::string(info.param.method); });

// The control: a linear spring at 0.99 of the limit swings by a factor of nearly 200 and is left alone.
TEST(EnergyAtTheLimit, OfALinearSpringIsNoEvent) {
  Session s(world(R"({"type":"oscillator","id":"o","mass":1,"stiffness":1,"position":0.7,"velocity":-0.7,
                      "integrator":"symplectic_euler"})",
                  1.98),
            std::make_shared<const ThreadArena>(1));
  EXPECT_EQ(s.step(2000), 2000u) << s.failure()->detail;
}

}  // namespace
}  // namespace truestep
