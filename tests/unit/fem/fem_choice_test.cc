// Which elements a body gets whose scene names none, and what is said of those that are too stiff. That the
// choices are accurate and the remedies help: tests/scenes/elements.
#include <gtest/gtest.h>

#include "engine/systems/fem/fem_choice.h"
#include "tests/unit/fem/fem_rig.h"

namespace truestep::fem {
namespace {

FemDef block(Vec3 size, int nx, int ny, int nz, Motion motion) {
  FemDef d;
  d.block = SoftBlockShape{.size = size, .cells_x = nx, .cells_y = ny, .cells_z = nz};
  d.motion = motion, d.pinned = {"x0"};
  return d;
}

TEST(FemChoice, WhatBendsIsOfSecondOrderWhileThatIsCheap) {
  const FemDef bar = block({10, 1, 1}, 20, 2, 2, Motion::quasi_static);
  EXPECT_EQ(cell_of(bar), Cell::hex27);
  EXPECT_EQ(cell_of(block({10, 1, 1}, 20, 2, 2, Motion::dynamic)), Cell::hex27);
  // Compact bodies in motion, and those of many cells, stay as cheap as they are.
  EXPECT_EQ(cell_of(block({1, 1, 1}, 4, 4, 4, Motion::dynamic)), Cell::hex8);
  EXPECT_EQ(cell_of(block({1, 1, 1}, 20, 20, 20, Motion::quasi_static)), Cell::hex8);
  FemDef panel;
  panel.quad = QuadShape{};
  EXPECT_EQ(cell_of(panel), Cell::quad9);
  panel.plane = Plane::membrane;
  EXPECT_EQ(cell_of(panel), Cell::quad4);
  panel.plane = Plane::shell;
  EXPECT_EQ(cell_of(panel), Cell::tri6);
}

TEST(FemChoice, WhatASceneNamesOrNumbersStays) {
  FemDef bar = block({10, 1, 1}, 20, 2, 2, Motion::quasi_static);
  bar.element = Cell::tet4;
  EXPECT_EQ(cell_of(bar), Cell::tet4);
  bar.element = Cell::automatic;
  bar.integrator = "rk4", bar.motion = Motion::dynamic;
  EXPECT_EQ(cell_of(bar), Cell::hex8);
  bar.integrator = "", bar.pins = {0};
  EXPECT_EQ(cell_of(bar), Cell::hex8);
  bar.pins.clear(), bar.sets = {{"end", {0, 1}, {}, {}}};
  EXPECT_EQ(cell_of(bar), Cell::hex8);
  bar.sets.clear(), bar.incompatible_modes = Incompatible::wilson;
  EXPECT_EQ(cell_of(bar), Cell::hex8);
}

TEST(FemChoice, VolumesFollowPoissonsRatio) {
  FemDef d = block({1, 1, 1}, 2, 2, 2, Motion::quasi_static);
  EXPECT_EQ(volume_of(d), Volume::pointwise);
  d.poisson_ratio = 0.49;
  EXPECT_EQ(volume_of(d), Volume::mean);
  d.volume = Volume::pointwise;
  EXPECT_EQ(volume_of(d), Volume::pointwise);
  d.volume = Volume::automatic, d.integrator = "vertex_block_descent", d.motion = Motion::dynamic;
  EXPECT_EQ(volume_of(d), Volume::pointwise);
  FemDef ball;
  ball.fill = FillShape{.ball = BallRegion{}, .spacing = 0.3};
  EXPECT_EQ(cell_of(ball), Cell::tet4);
  ball.volume = Volume::mean;
  EXPECT_EQ(cell_of(ball), Cell::tet10);
  FemDef panel;
  panel.quad = QuadShape{}, panel.poisson_ratio = 0.49;
  EXPECT_EQ(volume_of(panel), Volume::mean);
  panel.plane = Plane::stress;
  EXPECT_EQ(volume_of(panel), Volume::pointwise);
}

// A study of convergence divides the same elements.
TEST(FemChoice, RefinementKeepsTheElements) {
  FemDef d = block({1, 1, 1}, 4, 4, 4, Motion::quasi_static);
  ASSERT_EQ(cell_of(d), Cell::hex27);
  ASSERT_FALSE(fem_resolution().divide(&d, 4).has_value());
  EXPECT_EQ(d.block->cells_x, 16);
  EXPECT_EQ(cell_of(d), Cell::hex27);
}

std::vector<std::string> said_of(const FemDef& d) {
  testing_rig::FemRun run(d);
  std::vector<Warning> found;
  run.system->warn(run.state, 1.0 / 60, found);
  std::vector<std::string> out;
  for (const Warning& w : found) out.push_back(w.quantity);
  return out;
}
using Words = std::vector<std::string>;

TEST(FemChoice, WhatLocksIsWarnedOfAndTheRemedyIsNot) {
  FemDef bar = block({10, 1, 1}, 20, 2, 2, Motion::quasi_static);
  EXPECT_EQ(said_of(bar), Words{});
  bar.element = Cell::hex8;
  EXPECT_EQ(said_of(bar), Words{"locking.bending"});
  bar.element = Cell::hex27;
  EXPECT_EQ(said_of(bar), Words{});
  FemDef strip = block({1, 1e-3, 1e-3}, 4, 1, 1, Motion::quasi_static);
  EXPECT_EQ(said_of(strip), Words{"locking.stretch"});
  strip.block->cells_x = 50;
  EXPECT_EQ(said_of(strip), Words{});
  FemDef rubber = block({1, 1, 1}, 2, 2, 2, Motion::quasi_static);
  rubber.poisson_ratio = 0.499, rubber.volume = Volume::pointwise;
  EXPECT_EQ(said_of(rubber), Words{"locking.volume"});
  rubber.volume = Volume::mean;
  EXPECT_EQ(said_of(rubber), Words{});
  rubber.volume = Volume::automatic, rubber.element = Cell::tet4;
  EXPECT_EQ(said_of(rubber), Words{"locking.volume"});
  rubber.element = Cell::tet10;
  EXPECT_EQ(said_of(rubber), Words{});
}

}  // namespace
}  // namespace truestep::fem
