// Headings, bounds, images of a periodic box, coincident members.
#include <cmath>

#include "engine/base/errors.h"
#include "engine/kernels/flocking/steering.h"
#include "tests/unit/particles/flocking_rig.h"

namespace truestep::flocking {
namespace {

using testing_rig::FlockRun;

TEST(FlockingSteering, ATurnEndsAtItsLimitOrAtTheTarget) {
  const trig::SinCos limit = trig::sincos(0.2);
  const Vec3 half_way = turn_towards({1, 0, 0}, {0, 1, 0}, limit);
  EXPECT_NEAR(half_way.x, std::cos(0.2), 1e-15);
  EXPECT_NEAR(half_way.y, std::sin(0.2), 1e-15);
  const Vec3 near{std::cos(0.1), std::sin(0.1), 0};
  EXPECT_EQ(turn_towards({1, 0, 0}, near, limit), near);
  // Straight back, there is no side to turn to: any direction within the plane, by the limit.
  const Vec3 back = turn_towards({1, 0, 0}, {-1, 0, 0}, limit);
  EXPECT_NEAR(back.x, std::cos(0.2), 1e-15);
  EXPECT_EQ(back.z, 0);
}

TEST(FlockingSteering, NoiseKeepsHeadingsUnitAndWithinItsAngle) {
  for (int k = 0; k < 100; ++k) {
    const double u = k / 100.0;
    const Vec3 in_space = disturbed({0, 0.6, 0.8}, 1.0, false, {u, 1 - u, 0, 0});
    // Rounding of some ten operations on numbers of order 1.
    EXPECT_NEAR(norm(in_space), 1, 1e-14);
    EXPECT_GE(dot(in_space, Vec3{0, 0.6, 0.8}), std::cos(0.5) - 1e-14);
    const Vec3 in_plane = disturbed({0.6, 0.8, 0}, 1.0, true, {u, 0, 0, 0});
    EXPECT_NEAR(norm(in_plane), 1, 1e-14);
    EXPECT_GE(dot(in_plane, Vec3{0.6, 0.8, 0}), std::cos(0.5) - 1e-14);
  }
}

TEST(Flocking, SpeedAndTurnRateStayWithinTheirBounds) {
  FlockingDef d;
  d.count = 300, d.sides = Sides::open, d.half_extents = {2, 2, 2};
  d.min_speed = 0.8, d.max_speed = 1.5, d.max_turn_rate = 1.2, d.separation = 50;
  FlockRun run(d, 0.02);
  for (int k = 0; k < 50; ++k) {
    std::vector<Vec3> before;
    for (size_t i = 0; i < 300; ++i) before.push_back(normalized(run.velocity(i)));
    run.step();
    for (size_t i = 0; i < 300; ++i) {
      const double speed = norm(run.velocity(i));
      // The bounds themselves are reached, but for rounding of a unit vector.
      EXPECT_GE(speed, 0.8 - 1e-14);
      EXPECT_LE(speed, 1.5 + 1e-14);
      EXPECT_GE(dot(before[i], run.velocity(i)) / speed, std::cos(1.2 * 0.02) - 1e-13);
    }
  }
}

TEST(Flocking, NeighboursAreMetThroughPeriodicSides) {
  FlockingDef d;
  d.rule = Rule::vicsek, d.space = Space::plane, d.sides = Sides::periodic, d.noise = 0;
  d.half_extents = {3, 3, 0}, d.speed = 0;
  // In opposite corners, 0.2 sqrt 2 m apart through both sides.
  d.positions = {{-2.9, -2.9, 0}, {2.9, 2.9, 0}}, d.velocities = {{1, 0, 0}, {0, 1, 0}};
  FlockRun run(d, 1e-9);
  EXPECT_NEAR(run.observe("distance.nearest"), 0.2 * std::sqrt(2.0), 1e-13);
  EXPECT_EQ(run.observe("groups"), 1);
  d.sides = Sides::open;
  EXPECT_EQ(FlockRun(d, 1e-9).observe("groups"), 2);
}

TEST(Flocking, CoincidentAndResting) {
  FlockingDef d;
  d.min_speed = 0, d.positions = {{}, {}, {0.1, 0, 0}}, d.velocities = {{}, {}, {}};
  FlockRun run(d, 0.02);
  run.step(50);
  EXPECT_FALSE(run.state.first_bad().has_value());
}

TEST(Flocking, MembersFleeAPredator) {
  FlockingDef d;
  d.positions = {{0, 0, 0}}, d.velocities = {{1, 0, 0}}, d.predators = 1;
  d.half_extents = {1, 0, 0};  // the predator comes from -x
  FlockRun run(d, 0.02), alone(
                             [&] {
                               auto c = d;
                               c.predators = 0;
                               return c;
                             }(),
                             0.02);
  run.step(10), alone.step(10);
  EXPECT_GT(run.velocity(0).x, alone.velocity(0).x + 0.1);
}

/// Smallest distance of anybody from a ball of 1 m about `center` over 200 steps.
double nearest_to_ball(FlockingDef d, const Vec3& center, double h) {
  FlockRun run(d, h);
  double least = HUGE_VAL;
  for (int k = 0; k < 200; ++k) {
    run.step();
    for (size_t i = 0; i < run.state.rows(Columns::position); ++i) {
      least = std::min(least, norm(run.position(i) - center) - 1);
      if (d.rule == Rule::vicsek) {
        EXPECT_NEAR(norm(run.velocity(i)), d.speed, 1e-14);
      } else if (d.rule == Rule::reynolds) {
        EXPECT_GE(norm(run.velocity(i)), d.min_speed - 1e-14);
      }
    }
  }
  EXPECT_FALSE(run.state.first_bad().has_value());
  return least;
}

TEST(Flocking, NobodyFliesThroughAColliderNorStartsInOne) {
  for (const Rule rule : {Rule::reynolds, Rule::vicsek, Rule::cucker_smale}) {
    for (const Sides sides : {Sides::open, Sides::periodic}) {
      if (rule == Rule::cucker_smale && sides == Sides::periodic) continue;
      FlockingDef d;
      d.rule = rule, d.sides = sides, d.count = 200, d.half_extents = {3, 3, 3}, d.wall_strength = 20;
      SphereColliderDef ball;
      ball.center = {1.5, 0, 0}, ball.radius = 1;
      d.colliders = {ball};
      // Long steps, so that many fly further than the ball is thick.
      EXPECT_GE(nearest_to_ball(d, ball.center, 0.5), 0) << static_cast<int>(rule);
      // Control: without the ball they fly through its position.
      d.colliders.clear();
      EXPECT_LT(nearest_to_ball(d, ball.center, 0.5), -0.5);
    }
  }
}

TEST(Flocking, ACloseColliderIsSteeredClearOf) {
  FlockingDef d;
  d.positions = {{-4, 0.2, 0}}, d.velocities = {{1, 0, 0}}, d.wall_strength = 8;
  SphereColliderDef ball;
  ball.radius = 1;
  d.colliders = {ball};
  // Turned aside before it would touch, whereas bouncing alone touches.
  EXPECT_GT(nearest_to_ball(d, {}, 0.02), 0.05);
  d.wall_strength = 0;
  EXPECT_LT(nearest_to_ball(d, {}, 0.02), 0.01);
}

TEST(Flocking, WhoMeetsAColliderHeadOnGetsAroundIt) {
  FlockingDef d;
  d.positions = {{-4, 0, 0}}, d.velocities = {{1, 0, 0}}, d.wall_strength = 8;
  d.goal = {20, 0, 0}, d.goal_strength = 2;
  SphereColliderDef ball;
  ball.radius = 1;
  d.colliders = {ball};
  for (const Space space : {Space::plane, Space::solid}) {
    d.space = space;
    FlockRun run(d, 0.02);
    run.step(500);
    EXPECT_GT(run.position(0).x, 3);
  }
}

TEST(Flocking, CommandsAreChecked) {
  FlockingDef d;
  FlockRun run(d, 0.02);
  run.system.apply(run.state, {.kind = CommandKind::set_parameter, .value = 2, .name = "cohesion"});
  EXPECT_EQ(run.state.f64(Columns::weights)[2], 2);
  EXPECT_THROW(run.system.apply(run.state, {.kind = CommandKind::set_parameter, .value = 7, .name = "noise"}),
               Error);
  EXPECT_THROW(run.system.apply(run.state, {.kind = CommandKind::set_parameter, .name = "goal"}), Error);
  EXPECT_THROW(run.system.apply(run.state, {.kind = CommandKind::push, .index = 0}), Error);
}

}  // namespace
}  // namespace truestep::flocking
