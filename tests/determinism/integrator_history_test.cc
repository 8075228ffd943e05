// Methods with a memory of earlier steps continue with the same bits where only the state has survived: from
// a snapshot restored elsewhere, with a discarded workspace, after another state has used the workspace, and
// across the points where a history starts anew (commands, events; its greatest length is in
// tests/scenes/determinism/methods_with_a_memory.json).
#include <gtest/gtest.h>

#include "tests/support/runs/ode_run.h"

namespace truestep::test {
namespace {

// A Kepler ellipse with a bounce that changes a velocity now and then.
std::string ellipse(const std::string& integrator) {
  return R"("states": {"x": 0.5, "y": 0}, "velocities": {"x": 0, "y": 1.7320508075688772},
    "parameters": {"mu": 1},
    "second": {"x": "-mu * x / (x^2 + y^2)^1.5", "y": "-mu * y / (x^2 + y^2)^1.5"},
    "events": [{"name": "kick", "every": 2.503, "set": {"x'": "x' + 0.01"}}],
    "tolerance": 1e-8, "integrator": ")" +
         integrator + '"';
}

class History : public ::testing::TestWithParam<std::string> {};

TEST_P(History, ContinuesWithTheSameBits) {
  constexpr int kParts = 12, kSteps = 23;
  const std::string scene = ellipse(GetParam());
  OdeRun whole(scene, 0.05), restored(scene, 0.05), forgetful(scene, 0.05), shared(scene, 0.05),
      other(scene, 0.05);
  other.set("mu", 1.1);
  for (int part = 0; part < kParts; ++part) {
    if (part == 7) {
      for (OdeRun* run : {&whole, &restored, &forgetful, &shared}) run->set("mu", 0.9);
    }
    whole.steps(kSteps);
    restored.state = WorldState::deserialize(restored.state.serialize());
    restored.workspace.clear();
    restored.steps(kSteps);
    for (int k = 0; k < kSteps; ++k) {
      forgetful.workspace.clear();
      forgetful.steps(1);
      // Two states that share one workspace.
      shared.steps(1);
      std::swap(shared.workspace, other.workspace);
      other.steps(1);
      std::swap(shared.workspace, other.workspace);
    }
    ASSERT_EQ(restored.state.hash(), whole.state.hash()) << "restored, part " << part;
    ASSERT_EQ(forgetful.state.hash(), whole.state.hash()) << "forgetful, part " << part;
    ASSERT_EQ(shared.state.hash(), whole.state.hash()) << "shared, part " << part;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, History,
                         ::testing::Values("cvode_adams", "cvode_bdf", "ias15", "rkn86", "rkn1210", "dop853",
                                           "bdf2", "generalized_alpha"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace truestep::test
