// A method chosen for an accuracy reaches it, and the running estimate of the error is of its size.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/studies/precision/accuracy.h"
#include "engine/studies/scene_variant.h"
#include "tests/unit/studies/study_rig.h"

namespace truestep {
namespace {

using testing_rig::kOscillator;
using testing_rig::Study;
namespace json = boost::json;

TEST(Accuracy, NamesASystemWhoseMethodCanBeChosen) {
  const auto pointer = [](const char* accuracy, const char* system) {
    const auto report =
        read_scene(parse_json(std::string(R"({"schema_version":"1.0","name":"s","accuracy":)") + accuracy +
                              R"(,"systems":[)" + system + "]}"));
    return report.errors.empty() ? std::string() : report.errors.front().pointer;
  };
  const char* oscillator = R"({"type":"oscillator","id":"o","mass":1,"stiffness":1})";
  EXPECT_EQ(pointer(R"({"tolerance":1e-4})", oscillator), "");
  EXPECT_EQ(pointer(R"({"tolerance":1e-4,"system":"o"})", oscillator), "");
  EXPECT_EQ(pointer(R"({"tolerance":1e-4,"system":"p"})", oscillator), "/accuracy/system");
  const json::value one = parse_json(kOscillator);
  EXPECT_EQ(require_scene(read_scene(one)).integrated_system(""), 0u);
  EXPECT_EQ(require_scene(read_scene(one)).integrated_system("other"), std::nullopt);
}

json::value accurate(double tolerance) {
  json::value scene = parse_json(kOscillator);
  scene.as_object()["accuracy"] = json::object{{"tolerance", tolerance}};
  return scene;
}

// x(t) = e^{-t} (cos wt + sin wt / w), w^2 = 99, of kOscillator at its end.
double oscillator_end() {
  const double w = std::sqrt(99.0);
  return std::exp(-2.0) * (std::cos(2 * w) + std::sin(2 * w) / w);
}

TEST_F(Study, AccuracyIsReachedByWhatWasChosen) {
  for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
    const AccuracyOutcome chosen = choose_method(accurate(tolerance), 3, context);
    const World world = build_world(chosen.scene, context);
    WorldState state = world.initial_state();
    Workspace workspace;
    while (state.step < 200) world.step(state, workspace, arena, {});
    const double x = state.systems[0].f64(state.systems[0].at("position"))[0];
    const double error = std::abs(x / oscillator_end() - 1);
    EXPECT_LE(error, tolerance) << json::serialize(chosen.report.at("chosen"));
    // The running estimate has the size of the true error: within a factor of ten, or below the reference's
    // own rounding.
    const double estimate = *world.observe(state).find("error.estimate");
    EXPECT_LT(estimate, 10 * error + 1e-12);
    EXPECT_GT(estimate, 0.1 * error - 1e-12);
  }
}

TEST_F(Study, AccuracyThatNothingReachesIsRefusedWithWhatIsReachable) {
  json::value scene = accurate(1e-14);
  try {
    choose_method(scene, 1, context);
    FAIL() << "1e-14 over two seconds is below rounding";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "accuracy_unreachable");
    EXPECT_EQ(e.issues().at(0).pointer, "/accuracy/tolerance");
  }
}

TEST_F(Study, EstimateSurvivesASnapshotAndCostsNothingWhereNobodyAsks) {
  const World plain = build_world(parse_json(kOscillator), context),
              world = build_world(accurate(1e-4), context);
  EXPECT_FALSE(plain.observe(plain.initial_state()).find("error.estimate"));
  EXPECT_TRUE(plain.initial_state().finer.empty());
  WorldState a = world.initial_state();
  Workspace workspace;
  for (int n = 0; n < 50; ++n) world.step(a, workspace, arena, {});
  WorldState b = WorldState::deserialize(a.serialize());
  EXPECT_EQ(a, b);
  for (int n = 0; n < 50; ++n) world.step(a, workspace, arena, {}), world.step(b, workspace, arena, {});
  EXPECT_EQ(a.hash(), b.hash());
  EXPECT_EQ(world.observe(a).find("error.estimate"), world.observe(b).find("error.estimate"));
}

}  // namespace
}  // namespace truestep
