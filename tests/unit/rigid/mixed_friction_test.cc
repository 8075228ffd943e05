// Unlike surfaces rub with the root of the product of their frictions, in the plane as in space.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using testing_coupled::SceneRun;

// m/s, what a block that slides over a floor loses in 0.2 s.
double lost(const std::string& type, double block, double floor) {
  const auto body = [&](const std::string& half, double friction, const std::string& more) {
    const std::string box = R"("type": "box", "half_extents": )" + half;
    return "{" + (type == "rigid2d" ? R"("shapes": [{)" + box + "}]" : box) + R"(, "friction": )" +
           std::to_string(friction) + more + "}";
  };
  SceneRun run(R"({"time": {"dt": 0.005}, "systems": [{"type": ")" + type + R"(", "id": "b", "bodies": [)" +
               body("[50, 1, 50]", floor, R"(, "motion": "fixed", "position": [0, -1, 0])") + ", " +
               body("[0.5, 0.1, 0.5]", block, R"(, "position": [0, 0.1, 0], "velocity": [3, 0, 0])") +
               "]}]}");
  run.session.step(40);
  const State& s = run.session.state().systems[0];
  return 3 - load3(s.f64(s.at("velocity")).data(), 1).x;
}

TEST(MixedFriction, IsTheRootOfTheProduct) {
  for (const char* type : {"rigid2d", "rigid3d"}) {
    for (const auto& [block, floor] : {std::pair{0.5, 0.5}, {0.25, 0.64}, {0.64, 0.25}, {0.9, 0.1}}) {
      const double expected = std::sqrt(block * floor) * 9.81 * 0.2;
      EXPECT_NEAR(lost(type, block, floor) / expected, 1, 0.03) << type << " " << block << " " << floor;
    }
    EXPECT_NEAR(lost(type, 1, 0), 0, 1e-6) << type;
  }
}

}  // namespace
}  // namespace truestep
