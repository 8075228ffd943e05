// A liquid whose particles come and go, as a scene writes it: a session resumed from its snapshot goes on
// with the same bits.
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

constexpr const char* kFountain = R"({"gravity": [0, -9.81, 0], "time": {"dt": 0.02}, "systems": [
    {"type": "grid_fluid", "id": "water", "cells": [16, 16, 16], "advection": "apic", "side": {"kind": "slip"},
     "bodies": [{"shape": "box", "center": [0.5, 0.1, 0.5], "half_extents": [0.5, 0.1, 0.5]}],
     "emitters": [{"position": [0.5, 0.3, 0.5], "radius": 0.1, "speed": "3 m/s", "stop": 0.6, "dye": 1}],
     "kill_boxes": [{"center": [0.1, 0, 0.1], "half_extents": [0.1, 0.1, 0.1], "where": "inside"}],
     "max_particles": 9000}]})";
constexpr const char* kChannel = R"({"gravity": [0, -9.81, 0], "time": {"dt": 0.02}, "systems": [
    {"type": "grid_fluid", "id": "water", "cells": [32, 16], "size": [2, 1], "advection": "flip",
     "sides": {"x_min": {"kind": "inflow", "velocity": ["y < 0.3 ? 1 + 0.5*sin(9*t) : 0", "0"], "dye": 2},
               "x_max": {"kind": "outflow"}},
     "bodies": [{"shape": "box", "center": [1, 0.1, 0], "half_extents": [1, 0.1, 1]}],
     "kill_planes": [{"point": [0, 0.01, 0]}]}]})";

class LiquidSession : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, LiquidSession, ::testing::Values(kFountain, kChannel));

TEST_P(LiquidSession, SnapshotContinuesTheTrajectory) {
  SceneRun a(GetParam()), b(GetParam(), 4);
  a.session.step(20);
  b.session.restore(WorldState::deserialize(a.session.state().serialize()));
  const size_t before = a.session.state().systems[0].rows(0);
  for (int i = 0; i < 20; ++i) {
    a.session.step(1), b.session.step(1);
    ASSERT_EQ(a.session.hash(), b.session.hash()) << "step " << i;
  }
  EXPECT_NE(a.session.state().systems[0].rows(0), before) << "control: particles have come or gone";
  // Of another scene, or with a row too few: refused.
  WorldState bad = a.session.state();
  bad.systems[0].resize(1, bad.systems[0].rows(1) - 1);
  EXPECT_THROW(b.session.restore(bad), Error);
}

}  // namespace
}  // namespace truestep
