// Walkers, walls, paths and doors of the system "crowd".
#include <cmath>

#include "engine/base/errors.h"
#include "engine/core/energy.h"
#include "tests/unit/particles/crowd_rig.h"

namespace truestep::crowd {
namespace {

using testing_rig::CrowdRun;
using testing_rig::walker;

CrowdDef lone(Model model) {
  CrowdDef d;
  d.model = model, d.groups.resize(1), d.groups[0].positions = {{}}, d.groups[0].heading = {1, 0, 0};
  return d;
}

TEST(Crowd, ALoneWalkerComesToTheWantedSpeedExponentially) {
  CrowdDef d = lone(Model::social_force);
  d.groups[0].speed = 1.5;
  for (const double h : {1.0 / 60, 0.25}) {
    CrowdRun run(d, h);
    for (int k = 1; k <= 8; ++k) {
      run.step();
      // Rounding of a few operations per step: the driving force is integrated exactly for any step.
      EXPECT_NEAR(run.velocity(0).x, 1.5 * (1 - std::exp(-k * h / 0.5)), 1e-14);
    }
  }
  // Control: another relaxation time is detected at once.
  d.relaxation_time = 0.51;
  CrowdRun other(d, 0.25);
  other.step();
  EXPECT_GT(std::abs(other.velocity(0).x - 1.5 * (1 - std::exp(-0.5))), 1e-3);
}

TEST(Crowd, WhoLeansOnAWallIsHeldWhereForcesBalance) {
  CrowdDef d = lone(Model::social_force);
  d.walls = {{{{2, -5, 0}, {2, 5, 0}}}};
  CrowdRun run(d);
  run.step(2400);
  // m v0 / tau = A exp(gap / B) + k max(gap, 0) at rest; here without contact: gap = B log(214.4 / 2000) < 0.
  const double gap = 0.08 * std::log(80 * 1.34 / 0.5 / 2000);
  // 40 s are 80 relaxation times.
  EXPECT_NEAR(run.position(0).x, 2 - 0.3 + gap, 1e-9);
  EXPECT_NEAR(norm(run.velocity(0)), 0, 1e-9);
  // Control: away from the wall there is nothing to lean on.
  d.walls[0].points = {{2, 3, 0}, {2, 5, 0}};
  CrowdRun past(d);
  past.step(1200);
  EXPECT_GT(past.position(0).x, 10);
}

TEST(Crowd, APressedWalkerIsHeldByTheBody) {
  CrowdDef d = lone(Model::social_force);
  d.groups[0].speed = 30, d.walls = {{{{2, -5, 0}, {2, 5, 0}}}};
  CrowdRun run(d);
  run.step(1200);
  const double overlap = run.position(0).x - 1.7;
  EXPECT_GT(overlap, 0);
  // m v0 / tau = 4800 N. The last motion has decayed after 20 s.
  EXPECT_NEAR(2000 * std::exp(overlap / 0.08) + 1.2e5 * overlap, 4800, 1e-3);
  EXPECT_NEAR(run.observe("pressure.largest"), 4800 / (2 * 3.141592653589793 * 0.3), 1e-3);
}

TEST(Crowd, TwoHeadOnPassSymmetrically) {
  CrowdDef d;
  d.model = Model::orca;
  d.groups = {walker({-4, 0, 0}, {4, 0, 0}), walker({4, 0, 0}, {-4, 0, 0})};
  CrowdRun run(d);
  double smallest = HUGE_VAL, aside = 0;
  for (int k = 0; k < 900; ++k) {
    run.step();
    const Vec3 a = run.position(0), b = run.position(1);
    smallest = std::min(smallest, norm(a - b) - 0.6);
    aside = std::max(aside, std::abs(a.y));
    // Each does the same as the other, rotated by half a turn: to the bit.
    ASSERT_EQ(a, -b);
  }
  // Half-planes at the present velocities keep the next positions apart, to rounding.
  EXPECT_GT(smallest, -1e-9);
  EXPECT_GT(aside, 0.2);
  EXPECT_LT(norm(run.position(0) - Vec3{4, 0, 0}), 0.05);
  // Control: two who assume a smaller radius come much closer.
  for (GroupDef& g : d.groups) g.radius = 0.1;
  CrowdRun thin(d);
  smallest = HUGE_VAL;
  for (int k = 0; k < 900; ++k) {
    thin.step(), smallest = std::min(smallest, norm(thin.position(0) - thin.position(1)) - 0.6);
  }
  EXPECT_LT(smallest, -0.25);
}

/// A room 10 m x 10 m about (0, 0) with a wall across it that leaves `gap` at its upper end.
CrowdDef behind_a_wall(double gap) {
  CrowdDef d;
  d.walls = {{{{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}}, true}, {{{0, -5, 0}, {0, 5 - gap, 0}}}};
  d.groups.resize(1);
  d.groups[0].positions = {{-3, -3, 0}}, d.groups[0].goal = {3, -3, 0}, d.groups[0].leave = true;
  return d;
}

TEST(Crowd, WaysLeadAroundWalls) {
  for (const Model model : {Model::social_force, Model::orca}) {
    CrowdDef d = behind_a_wall(2);
    d.model = model;
    CrowdRun run(d);
    double highest = -5;
    for (int k = 0; k < 60 * 20 && run.people() > 0; ++k) {
      highest = std::max(highest, run.position(0).y);
      run.step();
    }
    EXPECT_EQ(run.people(), 0u);
    EXPECT_EQ(run.observe("left"), 1);
    EXPECT_GT(highest, 3);
    EXPECT_LT(highest, 4.4);
  }
}

TEST(Crowd, TheTimeOfAWayIsItsLength) {
  CrowdDef d = behind_a_wall(2);
  d.clearance = 0;
  const Walls walls(d, 2);
  const WayGrid grid(d, walls);
  const Navigation way(goal_of(d.groups[0]), &grid, walls, 0);
  const double exact = 2 * std::sqrt(9.0 + 36.0);  // twice from (-3, -3) to the wall's end at (0, 3)
  // First-order fast marching: its fronts lag by some h log(distance / h) behind a corner, and the wall is
  // thicker by half a spacing.
  EXPECT_NEAR(way.time({-3, -3, 0}), exact, 0.3);
  EXPECT_GE(way.time({-3, -3, 0}), exact - 0.1);
  EXPECT_EQ(way.direction({3, 0, 0}), (Vec3{0, -1, 0}));  // in sight: straight
}

TEST(Crowd, GoalsThatNoWayLeadsToAreRefused) {
  EXPECT_THROW(CrowdRun(behind_a_wall(0)), Error);
  CrowdDef d = behind_a_wall(2);
  d.groups[0].goal = {5, 0, 0};
  EXPECT_THROW(CrowdRun{d}, Error);
  d.groups[0].goal = {8, 0, 0};
  EXPECT_THROW(CrowdRun{d}, Error);
  // A door opens the way.
  d.doors = {{"east", {5, 0.5, 0}, {5, -0.5, 0}}};
  CrowdRun run(d);
  run.step(60 * 20);
  EXPECT_EQ(run.people(), 0u);
  EXPECT_EQ(run.observe("door.east.forward") + run.observe("door.east.backward"), 1);
  EXPECT_EQ(run.observe("door.east.backward"), 0);
}

TEST(Crowd, NobodyCrossesAWallHoweverFastOrLong) {
  for (const Model model : {Model::social_force, Model::orca}) {
    CrowdDef d = lone(model);
    d.groups[0].speed = 40, d.max_speed = 40, d.groups[0].velocity = {40, 3, 0};
    d.walls = {{{{2, -500, 0}, {2, 500, 0}}}};
    for (const double h : {1.0 / 60, 0.5, 3.0}) {
      CrowdRun run(d, h);
      run.step(20);
      EXPECT_LE(run.position(0).x, 2) << h;
    }
  }
}

TEST(Crowd, WhoStartsOnAWallLeavesIt) {
  CrowdDef d = lone(Model::social_force);
  d.walls = {{{{0, -5, 0}, {0, 5, 0}}}};
  CrowdRun run(d);
  run.step(300);
  // On its left side, seen along the wall: the side depends on the wall alone.
  EXPECT_LT(run.position(0).x, -1);
}

TEST(Crowd, CoincidentRestingAndWithoutSize) {
  for (const Model model : {Model::social_force, Model::orca}) {
    for (const double radius : {0.0, 0.3}) {
      CrowdDef d;
      d.model = model, d.groups.resize(1);
      GroupDef& g = d.groups[0];
      g.positions = {{}, {}, {}, {1, 0, 0}}, g.goal = {0, 0, 0}, g.speed = 0, g.radius = radius;
      d.walls = {{{{0, 0, 0}, {0, 1, 0}}}, {{{-9, -9, 0}, {-9, -9, 0}}}};
      d.groups[0].goal = {3, 0, 0};
      CrowdRun run(d);
      run.step(120);
      EXPECT_FALSE(run.state.first_bad().has_value());
      Observables out;
      run.system.observe(run.state, 2, out);
      EXPECT_EQ(out.find("people").value(), 4);
    }
  }
}

TEST(Crowd, StepsOfASixtiethAndLongerHoldInAThrong) {
  CrowdDef d;
  d.groups.resize(1);
  GroupDef& g = d.groups[0];
  g.count = 60, g.half_extents = {3, 3, 0}, g.goal = {0, 0, 0}, g.speed = 3;
  for (const double h : {1.0 / 60, 0.1}) {
    CrowdRun run(d, h);
    run.step(static_cast<uint64_t>(10 / h));
    // Everybody presses towards one point and comes to rest there: an instability would have no bound.
    EXPECT_LT(run.observe("speed.mean"), 0.3) << h;
    EXPECT_GT(run.observe("separation.smallest"), -0.2) << h;
  }
  d.max_substeps = 1;
  CrowdRun few(d, 0.1);
  EXPECT_THROW(few.step(100), Instability);
}

TEST(Crowd, AStartLeavesRoomForEverybody) {
  CrowdDef d;
  d.groups.resize(2);
  for (GroupDef& g : d.groups)
    g.count = 60, g.half_extents = {5, 5, 0}, g.heading = {1, 0, 0}, g.radius_deviation = 0.05;
  d.walls = {{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, true}};
  CrowdRun run(d);
  EXPECT_GE(run.observe("separation.smallest"), 0);
  EXPECT_NEAR(run.observe("speed.mean"), 0, 0);
}

TEST(Crowd, CommandsAreChecked) {
  CrowdRun run(lone(Model::social_force)), chosen(lone(Model::orca));
  run.system.apply(run.state, {.kind = CommandKind::impulse, .index = 0, .vector = {0, 80, 7}});
  EXPECT_EQ(run.velocity(0), (Vec3{0, 1, 0}));
  run.system.apply(run.state, {.kind = CommandKind::set_parameter, .value = 0, .name = "speed_factor"});
  run.step(1000);
  EXPECT_NEAR(norm(run.velocity(0)), 0, 1e-9);
  EXPECT_THROW(chosen.system.apply(chosen.state, {.kind = CommandKind::impulse, .index = 0}), Error);
  EXPECT_THROW(run.system.apply(run.state, {.kind = CommandKind::impulse, .index = 1}), Error);
  EXPECT_THROW(
      run.system.apply(run.state, {.kind = CommandKind::set_parameter, .value = -1, .name = "speed_factor"}),
      Error);
  EXPECT_THROW(run.system.apply(run.state, {.kind = CommandKind::set_parameter, .value = 1, .name = "speed"}),
               Error);
  EXPECT_THROW(run.system.apply(run.state, {.kind = CommandKind::pin, .index = 0}), Error);
}

}  // namespace
}  // namespace truestep::crowd
