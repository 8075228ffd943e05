// Attachments must add no energy to ropes and cloths that are solved implicitly. A link that moves a point
// according to the point's own mass stretches the springs attached to it, by h^2 k / m times the energy of
// the impulse.
#include <algorithm>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

// Two ropes in one line, 0.2 m apart, tied end to end. h omega is 9 and 12.
std::string ropes(const std::string& gravity, const std::string& a, const std::string& b,
                  const std::string& tie) {
  return R"({"gravity": )" + gravity + R"(, "time": {"dt": 0.016666666666666666}, "systems": [
      {"type": "mass_spring", "id": "a", "rope": {"from": [0, 1, 0], "to": [0.8, 1, 0], "links": 4},
       "mass": 0.05, "stiffness": 5000, )" +
         a + R"(},
      {"type": "mass_spring", "id": "b", "rope": {"from": [1, 1, 0], "to": [1.8, 1, 0], "links": 4},
       "mass": 0.05, "stiffness": 8000, )" +
         b + R"(}],
    "couplings": [{"type": "attachment", "id": "tie", "a": "a", "b": "b", "a_points": [-1], "b_points": [0], )" +
         tie + "}]}";
}

struct Rise {
  double start, most;
};
Rise rise(SceneRun& run, int steps) {
  Rise out{run.observe("energy.total"), 0};
  out.most = out.start;
  for (int k = 0; k < steps; ++k) {
    EXPECT_TRUE(run.session.step(1));
    out.most = std::max(out.most, run.observe("energy.total"));
  }
  return out;
}

constexpr const char* kDown = "[0, -9.81, 0]";
constexpr const char* kPinned = R"("pinned": ["first"])";
constexpr const char* kLoose = R"("velocity": [0, 0, 0])";
constexpr const char* kThrown = R"("velocity": [0, 1, 0.5])";
constexpr const char* kLink = R"("link": "rigid")";

// Moved according to their own masses, the points gained 8.7 J compared with 4.9 J in the fall, and half as
// much again when thrown.
TEST(AttachedEnergy, LinkedRopesGainNothing) {
  SceneRun fall(ropes(kDown, kPinned, kLoose, kLink)), thrown(ropes("[0, 0, 0]", kLoose, kThrown, kLink));
  for (SceneRun* run : {&fall, &thrown}) {
    const Rise r = rise(*run, 180);
    EXPECT_LT(r.most, r.start * (1 + 1e-9));
    EXPECT_LT(run->observe("tie.length.error"), 1e-12);
  }
  // The control: the ropes move, and the link has work to do.
  EXPECT_LT(fall.observe("a.momentum.y") + fall.observe("b.momentum.y"), 1);
  EXPECT_GT(thrown.observe("tie.impulse.sum"), 0.05);
}

// Kicks of this spring are unstable from h sqrt(k K) = 2 on; here it is 10.
TEST(AttachedEnergy, StiffSpringsBetweenRopesHold) {
  const std::string spring = R"("link": "spring", "stiffness": 9000)";
  SceneRun fall(ropes(kDown, kPinned, kLoose, spring)), thrown(ropes("[0, 0, 0]", kLoose, kThrown, spring));
  for (SceneRun* run : {&fall, &thrown}) {
    const Rise r = rise(*run, 180);
    EXPECT_LT(r.most, r.start * (1 + 1e-9));
  }
}

// No external forces: momentum is conserved to the solver's accuracy of 1e-10.
TEST(AttachedEnergy, LinkedRopesKeepTheirMomentum) {
  for (const char* tie : {kLink, R"("link": "spring", "stiffness": 9000, "damping": 0.3)"}) {
    SceneRun run(ropes("[0, 0, 0]", kLoose, kThrown, tie));
    const Sums before = sums(*run.world, run.session.state());
    run.session.step(180);
    const Sums after = sums(*run.world, run.session.state());
    EXPECT_LT(norm(after.linear - before.linear), 1e-9 * before.scale) << tie;
    EXPECT_GT(norm(run.observe3("tie.impulse")), 0.02 * before.scale) << tie;
  }
}

// The lower rope hangs on the link, which carries its weight, 5 points of 0.05 kg, once everything is at
// rest.
TEST(AttachedEnergy, LinkBearsTheWeightBelowIt) {
  for (const char* tie : {kLink, R"("link": "spring", "stiffness": 9000)"}) {
    SceneRun run(ropes(kDown, R"("pinned": ["first"], "damping": 0.2)", R"("damping": 0.2)", tie));
    run.session.step(1200);
    const double before = run.observe("tie.impulse.y");
    run.session.step(60);
    EXPECT_NEAR(run.observe("tie.impulse.y") - before, 5 * 0.05 * 9.81, 1e-3) << tie;
    EXPECT_NEAR(run.observe("a.reaction.y"), 10 * 0.05 * 9.81, 1e-3) << tie;  // the pinned point's weight too
  }
}

// A seam between two cloths, with two of its pairs on one point, and a particle that hangs on it.
TEST(AttachedEnergy, SeamsHoldTheirLengths) {
  SceneRun run(R"({"time": {"dt": 0.016666666666666666}, "systems": [
      {"type": "mass_spring", "id": "a", "cloth_grid": {"nx": 5, "ny": 5}, "pinned": ["corner_00"],
       "stiffness": 5000, "mass": 0.01},
      {"type": "mass_spring", "id": "b", "cloth_grid": {"origin": [1.2, 0, 0], "nx": 5, "ny": 5},
       "stiffness": 3000, "mass": 0.01},
      {"type": "particles", "id": "c", "positions": [[2.5, -0.5, 1]], "masses": [0.2]}],
    "couplings": [
      {"type": "attachment", "id": "seam", "a": "a", "b": "b", "link": "rigid",
       "a_points": [4, 9, 14, 19, 24, 24], "b_points": [0, 5, 10, 15, 20, 15]},
      {"type": "attachment", "id": "weight", "a": "b", "b": "c", "link": "rigid",
       "a_points": [24], "b_points": [0]}]})");
  const Rise r = rise(run, 120);
  EXPECT_LT(r.most, r.start + 1e-6);
  EXPECT_LT(run.observe("seam.length.error"), 1e-12);
  EXPECT_GT(run.observe("seam.impulse.sum"), 0.1);
}

}  // namespace
}  // namespace truestep
