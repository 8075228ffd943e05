// Liquids with a wrong density warn, and the suggested remedy works.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

SphDef pool(Method solver) {
  SphDef d;
  d.dimension = 2, d.high = {0.5, 1.5, 1}, d.spacing = 0.05, d.solver = solver;
  d.bodies = {{.center = {0.25, 0.5, 0}, .half_extents = {0.25, 0.5, 1}}};
  return d;
}
/// After a second at rest.
std::vector<Warning> warnings(const SphDef& d, double dt) {
  SphRun run(d, dt, {0, -9.81, 0});
  run.seconds(1);
  std::vector<Warning> out;
  run.system.warn(run.state, dt, out);
  return out;
}

TEST(SphWarnings, ASlowSoundIsNamedWithOneThatDoes) {
  SphDef d = pool(Method::wcsph);
  // The weight of a metre compresses by g H / 2 c^2, 8 % on the mean.
  d.sound_speed = 8;
  const auto slow = warnings(d, 1.0 / 60);
  ASSERT_EQ(slow.size(), 1u);
  EXPECT_EQ(slow[0].quantity, "density.mean_error");
  EXPECT_NEAR(slow[0].value, 9.81 / 128, 0.3 * 9.81 / 128);
  const std::string word = "a sound_speed of ";
  const size_t at = slow[0].detail.find(word);
  ASSERT_NE(at, std::string::npos) << slow[0].detail;
  d.sound_speed = std::stod(slow[0].detail.substr(at + word.size()));
  EXPECT_GT(d.sound_speed, 8);
  EXPECT_TRUE(warnings(d, 1.0 / 60).empty());
}

TEST(SphWarnings, ACompressedLiquidIsNamedWithTheStepThatDoes) {
  SphDef d = pool(Method::pbf);
  // Case pbf.claims: below 1 % with four iterations.
  EXPECT_TRUE(warnings(d, 1.0 / 60).empty());
  d.pbf_iterations = 2;
  const auto compressed = warnings(d, 1.0 / 60);
  ASSERT_EQ(compressed.size(), 1u);
  EXPECT_GT(compressed[0].value, 0.01);
  ASSERT_GT(compressed[0].suggested_dt, 0);
  EXPECT_TRUE(warnings(d, compressed[0].suggested_dt).empty());
  EXPECT_TRUE(warnings(pool(Method::dfsph), 1.0 / 60).empty()) << "control: a solve to its tolerance";
}

// dfsph gave the residual of its solve, which removes no more than 2 % of an overlap at once: 1e-5 where the
// liquid was pressed into half its room, and no warning.
TEST(SphWarnings, WhatDfsphIsOffByIsThatOfItsState) {
  SphDef d = pool(Method::dfsph);
  const auto first = [&] {
    SphRun run(d, 1.0 / 60, {0, -9.81, 0});
    run.step();
    std::vector<Warning> out;
    run.system.warn(run.state, 1.0 / 60, out);
    EXPECT_EQ(run.observe("density.mean_error"), run.observe("compression.mean"));
    EXPECT_EQ(run.observe("density.max_error"), run.observe("compression.max"));
    return out;
  };
  EXPECT_TRUE(first().empty()) << "control: one pool";
  d.bodies.push_back(d.bodies[0]);
  const auto doubled = first();
  ASSERT_EQ(doubled.size(), 1u);
  EXPECT_GT(doubled[0].value, 0.3);
}

// A box full of liquid without sides was told to step shorter or to solve longer, neither of which changes
// its density.
TEST(SphWarnings, AFullBoxIsToldOfShifting) {
  SphDef d;
  d.dimension = 2, d.spacing = 0.05, d.kernel = Smoothing::wendland_c2, d.support = 3;
  d.viscosity = 0.01, d.xsph = 0, d.periodic = Periodic::xy, d.shifting = 0;
  d.bodies = {{.center = {0.5, 0.5, 0}, .half_extents = {0.5, 0.5, 1}}};
  d.initial = {"-cos(2 * pi * x) * sin(2 * pi * y)", "sin(2 * pi * x) * cos(2 * pi * y)"};
  const auto after = [&d] {
    SphRun run(d, 0.005);
    run.seconds(0.3);
    std::vector<Warning> out;
    run.system.warn(run.state, run.h, out);
    return out;
  };
  const auto gathered = after();
  ASSERT_EQ(gathered.size(), 1u);
  EXPECT_NE(gathered[0].detail.find("shifting"), std::string::npos) << gathered[0].detail;
  EXPECT_EQ(gathered[0].suggested_dt, 0);
  d.shifting = 4;
  EXPECT_TRUE(after().empty()) << "control: the remedy works";
}

}  // namespace
}  // namespace truestep::sph
