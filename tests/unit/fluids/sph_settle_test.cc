// What settles before time starts, and what does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

/// A pool of ten rows, and a ball of liquid above it that falls.
SphDef pool_and_ball(double settle) {
  SphDef d;
  d.dimension = 2, d.spacing = 0.05, d.settle = settle;
  d.bodies = {{.center = {0.5, 0.25, 0}, .half_extents = {0.5, 0.25, 1}},
              {.shape = Shape::ball, .center = {0.5, 0.8, 0}, .velocity = {0, -1, 0}, .radius = 0.1}};
  return d;
}

TEST(SphSettle, WhatMovesAtTheStartWaits) {
  const SphRun on_lattice(pool_and_ball(0), 1.0 / 60, {0, -9.81, 0}),
      settled(pool_and_ball(2), 1.0 / 60, {0, -9.81, 0});
  constexpr size_t kPool = 200;
  const size_t n = on_lattice.system.setting().rows;
  ASSERT_GT(n, kPool);
  double moved = 0;
  for (size_t i = 0; i < n; ++i) {
    const double by = norm(settled.position(i) - on_lattice.position(i));
    if (i < kPool) {
      moved = std::max(moved, by);
      EXPECT_EQ(norm(settled.velocity(i)), 0) << i;
    } else {
      EXPECT_EQ(by, 0) << i;
      EXPECT_EQ(settled.velocity(i).y, -1) << i;
    }
  }
  EXPECT_GT(moved, 1e-3) << "control: rows of a lattice do not stay";
  // It carries its weight from the start: on the mean half of the pressure on its floor.
  EXPECT_NEAR(settled.observe("pressure.mean") * static_cast<double>(n) / kPool, 1000 * 9.81 * 0.25,
              0.1 * 1000 * 9.81 * 0.25);
}

TEST(SphSettle, IsTheSameEachTimeAndNotForNothing) {
  SphDef d = pool_and_ball(0.5);
  SphRun a(d, 1.0 / 60, {0, -9.81, 0}), b(d, 1.0 / 60, {0, -9.81, 0}, 2);
  EXPECT_EQ(a.state.hash(), b.state.hash());
  a.step(3), b.step(3);
  EXPECT_EQ(a.state.hash(), b.state.hash());
  d.settle = 0.6;
  EXPECT_NE(SphRun(d, 1.0 / 60, {0, -9.81, 0}).system.initial_state().hash(), b.system.initial_state().hash())
      << "control";
}

TEST(SphSettle, LiquidThatStartsWithVelocitiesHasThemWhereItSettled) {
  SphDef d = pool_and_ball(1);
  d.bodies.resize(1), d.initial = {"y", "0"};
  const SphRun run(d, 1.0 / 60, {0, -9.81, 0});
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    // Positions and velocities are floats.
    EXPECT_NEAR(run.velocity(i).x, run.position(i).y, 1e-6) << i;
  }
}

// A hollow is room for a body: liquid that settles stays out of it, closer than particles to any wall.
TEST(SphSettle, HollowsStayEmpty) {
  SphDef d = pool_and_ball(2);
  d.bodies.resize(1);
  d.hollows = {{.shape = Shape::ball, .center = {0.5, 0.25, 0}, .radius = 0.15},
               {.center = {0.15, 0.3, 0}, .half_extents = {0.1, 0.1, 1}}};
  SphRun run(d, 1.0 / 60, {0, -9.81, 0});
  const auto inside = [&] {
    int count = 0;
    for (size_t i = 0; i < run.system.setting().rows; ++i) {
      const Vec3 x = run.position(i);
      count +=
          std::any_of(d.hollows.begin(), d.hollows.end(), [&](const HollowDef& h) { return h.contains(x); });
    }
    return count;
  };
  EXPECT_EQ(inside(), 0);
  run.seconds(0.5);
  EXPECT_GT(inside(), 10) << "control: nothing keeps them empty once time runs";
}

TEST(SphSettle, ThePlanSaysSo) {
  const auto row = [](double settle) {
    const SphRun run(pool_and_ball(settle), 1.0 / 60, {0, -9.81, 0});
    for (const PlanRow& r : run.system.plan()) {
      if (r.name == "settling") return r;
    }
    return PlanRow{};
  };
  EXPECT_EQ(row(0.5).status, PlanRow::Status::runs);
  EXPECT_NE(row(0.5).reason.find("0.5 s"), std::string::npos) << row(0.5).reason;
  EXPECT_EQ(row(0).status, PlanRow::Status::skipped);
}

}  // namespace
}  // namespace truestep::sph
