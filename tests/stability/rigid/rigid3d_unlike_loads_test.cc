// Contacts whose points carry unequal loads: one offset for all of them would lift the points that carry
// less, at the start by 1 um to 0.4 mm, which would be energy from nowhere.
#include <algorithm>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

/// A body that rests on the ground and, off its middle, on a small light box on the ground.
std::string leaning_on(const std::string& top, const std::string& precision) {
  return R"({"gravity": [0, -9.81, 0], "time": {"dt": 0.016666666666666666}, "systems": [
      {"type": "rigid3d", "id": "a", "precision": ")" +
         precision + R"(", "bodies": [
        {"type": "plane", "motion": "fixed", "friction": 0.78},
        {"type": "box", "half_extents": [0.188, 0.142, 0.098], "position": [-0.04, 0.142, 0], "density": 170,
         "friction": 0.5},)" +
         top + "]}]}";
}

constexpr const char* kLoadBox =
    R"({"type": "box", "half_extents": [0.3, 0.455, 0.32], "position": [0.024, 0.739, 0], "density": 263})";
constexpr const char* kBall =
    R"({"type": "sphere", "radius": 0.3, "position": [0.01, 0.584, 0], "density": 800})";

/// J, largest gain over the start in 4 s.
double gain(Session& s) {
  const auto total = [&] { return s.observe().find("a.energy.total").value(); };
  const double start = total();
  double most = 0;
  for (int k = 0; k < 240; ++k) s.step(1), most = std::max(most, total() - start);
  return most;
}

// 1e-8 of some 700 J: impulses are floats, of which a step adds a few.
TEST(Rigid3dUnlikeLoads, LiftNothing) {
  for (const char* precision : {"f32", "f64"}) {
    for (const char* top : {kLoadBox, kBall}) {
      SceneRun run(leaning_on(top, precision));
      EXPECT_LT(gain(run.session), 1e-5) << precision << ", " << top;
    }
  }
  // The control: the energy of a push is seen.
  SceneRun pushed(leaning_on(kBall, "f32"));
  const double before = pushed.session.observe().find("a.energy.total").value();
  Command c;
  c.kind = CommandKind::impulse, c.system = "a", c.index = 2, c.vector = {0, 100, 0};
  pushed.session.command(c);
  pushed.session.step(1);
  EXPECT_GT(pushed.session.observe().find("a.energy.total").value() - before, 1e-3);
}

}  // namespace
}  // namespace truestep
