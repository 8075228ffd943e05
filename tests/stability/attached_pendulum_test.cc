// Bodies that hang below a rope on links and springs of some length: they swing like pendulums on the rope's
// point and turn as freely as without them.
#include <algorithm>
#include <cmath>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

struct Swing {
  double most, end;  ///< J above what it started with: the most on the way, and at the end
};

/// A ball of 1 kg on a line of 1 m that starts at 45 degrees, below the middle of a taut rope, for 10 s.
Swing swing(const std::string& tie, int steps_per_second) {
  SceneRun run(R"({"gravity": [0, -9.81, 0], "time": {"dt": )" + std::to_string(1.0 / steps_per_second) +
               R"(}, "systems": [
      {"type": "mass_spring", "id": "a", "rope": {"from": [-0.5, 3, 0], "to": [0.5, 3, 0], "links": 2}, "mass": 0.1,
       "stiffness": 1e6, "pinned": ["first", "last"]},
      {"type": "rigid3d", "id": "b", "bodies": [
        {"type": "sphere", "position": [0.70710678, 2.29289322, 0], "mass": 1, "radius": 0.1}]}],
    "couplings": [{"type": "attachment", "id": "tie", "a": "a", "b": "b", "a_points": [1], "b_points": [0], )" +
               tie + "}]}");
  const double start = run.observe("energy.total");
  Swing out{0, 0};
  for (int k = 0; k < 10 * steps_per_second; ++k) {
    EXPECT_TRUE(run.session.step(1));
    out.end = run.observe("energy.total") - start;
    out.most = std::max(out.most, out.end);
  }
  return out;
}

constexpr double kFall = 9.81 * (1 - 0.70710678);  // J that its fall to the bottom frees
constexpr const char* kOnLink = R"("link": "rigid")";
constexpr const char* kOnSpring = R"("link": "spring", "stiffness": 1e5)";

// Pulled along the direction that the line had a step ago they gained: at 60 Hz a rigid link ended with 900
// times the energy of the swing and an event. Pulled along that of the step's end they lose two thirds;
// midway 6 % at 60 Hz, which is what both bounds tell apart from either.
TEST(AttachedPendulum, SwingsWithoutGainAndWithLittleLoss) {
  for (const char* tie : {kOnLink, kOnSpring}) {
    for (const int rate : {30, 60, 240}) {
      const Swing s = swing(tie, rate);
      EXPECT_LT(s.most, 1e-3 * kFall) << tie << " at " << rate;
      EXPECT_GT(s.end, (rate == 30 ? -0.25 : rate == 60 ? -0.1 : -0.04) * kFall) << tie << " at " << rate;
    }
  }
}

// A spinning capsule held at its centre of mass half a metre below a cloth: nothing turns it. As if it
// reached up to the cloth, the pull of a step ago did, and doubled its spin every three steps (6,663 J after
// a second).
TEST(AttachedPendulum, WhatIsHeldAtItsCentreKeepsItsSpin) {
  for (const char* tie : {kOnLink, kOnSpring}) {
    SceneRun run(R"({"gravity": [0, -9.81, 0], "time": {"dt": 0.03333333333333333}, "systems": [
      {"type": "mass_spring", "id": "a", "cloth_grid": {"origin": [0, 3, 0], "edge_u": [0.627, 0, 0],
       "edge_v": [0, 0, 0.627], "nx": 4, "ny": 4}, "mass": 0.047, "stiffness": 8788, "shear_stiffness": 812,
       "pinned": ["corners"]},
      {"type": "rigid3d", "id": "b", "precision": "f64", "bodies": [{"type": "capsule", "position": [0.3137, 2.5, 0.3137],
       "mass": 0.25, "angular_velocity": [-4.64, 1.81, 5], "radius": 0.0576, "half_length": 0.0797}]}],
    "couplings": [{"type": "attachment", "id": "tie", "a": "a", "b": "b", "a_points": [8], "b_points": [0], )" +
                 std::string(tie) + "}]}");
    const double spin = run.observe("b.energy.rotation"), all = run.observe("energy.total");
    ASSERT_TRUE(run.session.step(90));
    EXPECT_NEAR(run.observe("b.energy.rotation") / spin, 1, 1e-6) << tie;
    EXPECT_LT(run.observe("energy.total"), all) << tie;
    EXPECT_GT(run.observe("tie.impulse.sum"), 5) << tie;  // the control: it is held
  }
}

}  // namespace
}  // namespace truestep
