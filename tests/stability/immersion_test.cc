// Bodies of all weights in water: nothing blows up, and floating bodies come to rest.
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/random.h"
#include "tests/support/immersed_scenes.h"

namespace truestep {
namespace {

using namespace testing_coupled;

// A ball of a twentieth of the water's density has to move ten times its own mass in water: an exchange of
// forces from step to step would blow up.
TEST(ImmersionStability, AVeryLightBallFloatsCalmly) {
  for (const char* solver : {"dfsph", "wcsph"}) {
    Bath bath;
    bath.size = {0.4, 0.5, 0.4}, bath.depth = 0.2;
    bath.body = R"("type": "sphere", "radius": 0.08, "position": [0.2, 0.22, 0.2], "density": 50)";
    bath.hollow = R"("shape": "ball", "center": [0.2, 0.22, 0.2], "radius": 0.08)";
    bath.water = std::string(R"(, "solver": ")") + solver + "\"";
    SceneRun run(bath.scene());
    run.session.step(120);
    EXPECT_GT(body_height(run), 0.24) << solver << ": it has come up";
    EXPECT_LT(body_height(run), 0.29) << solver;
    double fastest = 0;
    for (int k = 0; k < 40; ++k) {
      run.session.step(1);
      fastest = std::max(fastest, norm(body_velocity(run)));
    }
    // A tenth of the wave speed at this depth.
    EXPECT_LT(fastest, 0.1 * std::sqrt(9.81 * 0.2)) << solver;
  }
}

TEST(ImmersionStability, WhatIsThrownInStaysFiniteAndLosesEnergy) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    uint64_t draws = 0;
    const auto draw = [&](double low, double high) {
      return low + (high - low) * uniform4(seed, 0, draws++)[0];
    };
    Bath bath;
    bath.size = {0.5, 0.8, 0.5}, bath.depth = 0.2;
    std::string bodies;
    for (int k = 0; k < 4; ++k) {
      bodies += std::string(k ? "}, {" : "") + R"("type": "box", "half_extents": )" +
                triple({draw(0.03, 0.07), draw(0.03, 0.07), draw(0.03, 0.07)}) + R"(, "position": )" +
                triple({0.15 + 0.2 * (k % 2), 0.36 + 0.05 * k, 0.15 + 0.2 * (k / 2)}) +
                R"(, "velocity": [0, )" + number(draw(-3, 0)) + R"(, 0], "angular_velocity": )" +
                triple({draw(-5, 5), draw(-5, 5), draw(-5, 5)}) + R"(, "density": )" +
                number(std::exp(draw(std::log(50.0), std::log(5000.0))));
    }
    bath.body = bodies;
    const char* solvers[] = {"dfsph", "wcsph", "pbf"};
    bath.water = std::string(R"(, "solver": ")") + solvers[seed % 3] + "\"";
    SceneRun run(bath.scene());
    const double before = run.observe("water.energy.total") + run.observe("crates.energy.total");
    run.session.step(60);
    const double after = run.observe("water.energy.total") + run.observe("crates.energy.total");
    EXPECT_TRUE(std::isfinite(after)) << seed;
    EXPECT_LT(after, before) << seed;
    EXPECT_LT(run.observe("water.speed.max"), 6) << seed << ": what falls 1 m has 4.5 m/s";
  }
}

// Steps in which a body falls far are divided, since it falls as if the water did what it did in the step
// before. Cork was thrown 28 m high.
TEST(ImmersionStability, StepsInWhichABodyWouldFallFarAreDivided) {
  Bath bath;
  bath.size = {0.4, 0.5, 0.4}, bath.depth = 0.2, bath.spacing = 0.04, bath.dt = 0.8;
  bath.body = R"("type": "sphere", "radius": 0.08, "position": [0.2, 0.22, 0.2], "density": 240)";
  bath.hollow = R"("shape": "ball", "center": [0.2, 0.22, 0.2], "radius": 0.08)";
  SceneRun run(bath.scene());
  const auto substeps = run.world->scene().substeps();
  // A tenth of a spacing: sqrt(2 0.004 m / 9.81 m/s^2) = 0.0286 s.
  EXPECT_EQ(substeps, 29);
  for (int k = 0; k < 4; ++k) {
    run.session.step(1);
    EXPECT_GT(body_height(run), 0.18) << "after step " << k;
    EXPECT_LT(body_height(run), 0.32) << "after step " << k;
  }
  // Control: one that would fall a tenth of a spacing is not divided, and without gravity none is.
  bath.dt = 0.028;
  EXPECT_EQ(SceneRun(bath.scene()).world->scene().substeps(), 1);
  bath.dt = 0.8, bath.gravity = {};
  EXPECT_EQ(SceneRun(bath.scene()).world->scene().substeps(), 1);
}

TEST(ImmersionStability, ASceneThatChoosesTooFewSubstepsIsToldHowManyWork) {
  Bath bath;
  bath.size = {0.4, 0.5, 0.4}, bath.depth = 0.2, bath.spacing = 0.04, bath.dt = 0.19;
  bath.body = R"("type": "sphere", "radius": 0.08, "position": [0.2, 0.3, 0.2], "density": 240)";
  const auto with = [&](int substeps) {
    std::string scene = bath.scene();
    const std::string time = R"("time": {)";
    scene.insert(scene.find(time) + time.size(), "\"substeps\": " + std::to_string(substeps) + ", ");
    return scene;
  };
  try {
    const SceneRun run(with(6));
    FAIL() << "0.032 s a substep";
  } catch (const Error& e) {
    ASSERT_EQ(e.issues().size(), 1u);
    EXPECT_EQ(e.issues()[0].pointer, "/time/substeps");
    EXPECT_NE(e.issues()[0].allowed.find(">= 7"), std::string::npos) << e.issues()[0].allowed;
  }
  EXPECT_EQ(SceneRun(with(7)).world->scene().substeps(), 7);
}

}  // namespace
}  // namespace truestep
