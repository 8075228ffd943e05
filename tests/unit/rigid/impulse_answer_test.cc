#include <cmath>

#include "engine/core/equations/impulse_answer.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

// A rope of four links at rest, with one end held; h^2 k / m = 139.
constexpr const char* kRope = R"({"gravity": [0, 0, 0], "time": {"dt": 0.016666666666666666}, "systems": [
    {"type": "mass_spring", "id": "rope", "rope": {"from": [0, 0, 0], "to": [1, 0, 0], "links": 4}, "mass": 0.01,
     "stiffness": 5000, "pinned": ["first"], "integrator": "linear_implicit_euler"}]})";

struct Answered {
  explicit Answered(const Vec3& impulse, size_t row) : run(kRope), state(run.session.state().systems[0]) {
    const auto n = state.f64(1).size();
    impulses.assign(n, 0), dv.assign(n, 0);
    store3(impulses.data(), row, impulse);
    const StepInput in{.h = 1.0 / 60, .workspace = workspace, .arena = arena};
    const AnswersImpulses* answers = answers_together(run.world->system(0));
    EXPECT_NE(answers, nullptr);
    answers->answer(state, in, AnswersImpulses::Answer::first, impulses, dv);
  }
  SceneRun run;
  State state;
  Workspace workspace;
  ThreadArena arena{1};
  std::vector<double> impulses, dv;
};

// Small impulses along a straight rope at rest: the response of a step to a kick at its start is linear.
TEST(ImpulseAnswer, IsWhatAStepMakesOfAKick) {
  const Vec3 impulse{1e-6, 0, 0};
  Answered answered(impulse, 4);
  SceneRun kicked(kRope);
  Command kick;
  kick.kind = CommandKind::impulse, kick.system = "rope", kick.index = 4, kick.vector = impulse;
  kicked.session.command(kick);
  kicked.session.step(1);
  const State& after = kicked.session.state().systems[0];
  const State before = kicked.world->initial_state().systems[0];
  const double largest = std::abs(answered.dv[12]);
  EXPECT_GT(largest, 0);
  for (size_t k = 0; k < answered.dv.size(); ++k) {
    EXPECT_NEAR(answered.dv[k], after.f64(1)[k], 1e-6 * largest) << k;
    EXPECT_NEAR(answered.dv[k] / 60, after.f64(0)[k] - before.f64(0)[k], 1e-6 * largest) << k;
  }
  // The control: by its own mass alone the point would have moved eleven times as far as the rope allows.
  EXPECT_LT(largest, 0.2 * impulse.x / 0.01);
}

TEST(ImpulseAnswer, IsSymmetric) {
  const Answered from_two({0.3, 0.2, 0}, 2), from_four({0.1, -0.4, 0.7}, 4);
  EXPECT_NEAR(dot(load3(from_two.dv.data(), 4), Vec3{0.1, -0.4, 0.7}),
              dot(load3(from_four.dv.data(), 2), Vec3{0.3, 0.2, 0}), 1e-9);
  EXPECT_GT(std::abs(dot(load3(from_two.dv.data(), 4), Vec3{0.1, -0.4, 0.7})), 1e-3);
}

TEST(ImpulseAnswer, HeldRowsDoNotAnswer) {
  const Answered answered({1, 1, 1}, 0);
  for (const double v : answered.dv) EXPECT_EQ(v, 0);
}

TEST(ImpulseAnswer, PointsOfExplicitMethodsAnswerAlone) {
  std::string leapfrog = kRope;
  leapfrog.replace(leapfrog.find("linear_implicit_euler"), 21, "leapfrog");
  const SceneRun run(leapfrog);
  EXPECT_EQ(answers_together(run.world->system(0)), nullptr);
}

}  // namespace
}  // namespace truestep
