// Explicit methods near their limit: their energy swings, by no more than the watch allows for. (What gains
// more is an event: tests/scenes/soft/energy_near_the_limit_is_an_event.json.)
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "engine/core/energy_swing.h"
#include "engine/scene/json/json.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

std::shared_ptr<const World> world(const std::string& system, double dt) {
  return std::make_shared<const World>(
      parse_scene(R"({"schema_version":"1.0","gravity":[0,0,0],"time":{"dt":)" + std::to_string(dt) +
                  R"(,"duration":20},"systems":[)" + system + "]}"));
}

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

}  // namespace
}  // namespace truestep
