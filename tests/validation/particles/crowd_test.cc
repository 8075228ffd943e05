// Crowds against published results: people who change places on a circle, lanes of opposite streams, and a
// room that is left through one door (Helbing, Farkas, Vicsek 2000, Nature 407:487).
#include <cmath>

#include "tests/unit/particles/crowd_rig.h"

namespace truestep::crowd {
namespace {

using testing_rig::CrowdRun;

constexpr double kTurn = 6.283185307179586;

struct Swap {
  double smallest = HUGE_VAL, arrived = 0;
};

/// A hundred people on a circle of 12 m who head for the opposite point.
Swap swap_places(const CrowdDef& model, double seconds) {
  CrowdDef d = model;
  d.groups.resize(1);
  GroupDef& g = d.groups[0];
  for (int k = 0; k < 100; ++k) {
    const Vec3 p{12 * std::cos(kTurn * k / 100), 12 * std::sin(kTurn * k / 100), 0};
    g.positions.push_back(p), g.goals.push_back(-p);
  }
  g.radius = 0.25, g.speed = 1.3;
  CrowdRun run(d, 1.0 / 30);
  Swap s;
  for (int k = 0; k < 30 * seconds; ++k) {
    run.step();
    s.smallest = std::min(s.smallest, run.observe("separation.smallest"));
  }
  s.arrived = run.observe("arrived");
  return s;
}

TEST(CrowdValidation, AHundredChangePlacesAndNobodyTouchesAnybody) {
  CrowdDef d;
  d.model = Model::orca, d.max_speed = 1.6, d.noise = 0.05;
  const Swap s = swap_places(d, 120);
  EXPECT_EQ(s.arrived, 100);
  // Nobody takes more than half of a gap in a step: what remains is rounding of velocities (1e-10 m/s).
  EXPECT_GT(s.smallest, -1e-9);
  // Control: social forces let people in the middle be compressed.
  d.model = Model::social_force;
  EXPECT_LT(swap_places(d, 30).smallest, -1e-3);
}

TEST(CrowdValidation, NobodyOverlapsByAgreementWhateverTheStep) {
  for (const double h : {1.0 / 60, 0.1, 0.5}) {
    CrowdDef d;
    d.model = Model::orca, d.groups.resize(1), d.horizon = 0.1, d.margin = 0;
    GroupDef& g = d.groups[0];
    g.count = 80, g.half_extents = {6, 6, 0}, g.goal = {0, 0, 0}, g.speed = 3;
    d.walls = {{{{-3, -3, 0}, {3, -3, 0}, {3, 3, 0}}}};
    CrowdRun run(d, h);
    double smallest = HUGE_VAL;
    for (int k = 0; k < 20 / h; ++k) {
      run.step(), smallest = std::min(smallest, run.observe("separation.smallest"));
    }
    EXPECT_GT(smallest, -1e-9) << h;
    // They do come close: the bound is reached.
    EXPECT_LT(smallest, 1e-3) << h;
  }
}

CrowdDef corridor() {
  CrowdDef d;
  d.period = 30, d.noise = 0.3;
  d.walls = {{{{-15, -4, 0}, {15, -4, 0}}}, {{{-15, 4, 0}, {15, 4, 0}}}};
  d.groups.resize(2);
  for (GroupDef& g : d.groups) {
    g.count = 60, g.half_extents = {14.7, 3.6, 0}, g.speed = 1.3, g.speed_deviation = 0.1, g.radius = 0.25;
  }
  d.groups[0].heading = {1, 0, 0}, d.groups[1].heading = {-1, 0, 0};
  return d;
}

/// Order of lanes at the start and after 120 s, means over three seeds.
std::array<double, 2> lanes(const CrowdDef& d) {
  std::array<double, 2> out{};
  for (const uint64_t seed : {1, 2, 3}) {
    CrowdRun run(d, 1.0 / 30, 1, seed);
    out[0] += run.observe("lanes.order") / 3;
    run.step(3600);
    out[1] += run.observe("lanes.order") / 3;
  }
  return out;
}

TEST(CrowdValidation, OppositeStreamsFormLanes) {
  const auto [start, end] = lanes(corridor());
  // In a random arrangement each strip of 0.8 m of the 7.2 m holds 13 of 120 people: the mean square of the
  // excess fraction in one direction is 1 / 13 = 0.08, and the mean over 360 people, of some 27 strips, has a
  // standard error of 0.02.
  EXPECT_NEAR(start, 0.08, 0.06);
  // Perfect lanes would give 1; people next to another lane see some of it.
  EXPECT_GT(end, 0.7);
  // Control: people who do not react to each other mix forever.
  CrowdDef ghosts = corridor();
  ghosts.repulsion = ghosts.body_stiffness = ghosts.sliding_friction = 0;
  EXPECT_NEAR(lanes(ghosts)[1], 0.08, 0.06);
  // By agreement of velocities, too.
  CrowdDef agreed = corridor();
  agreed.model = Model::orca;
  EXPECT_GT(lanes(agreed)[1], 0.6);
}

CrowdDef room(double speed) {
  CrowdDef d;
  d.walls = {{{{-15, -7.5, 0}, {0, -7.5, 0}, {0, 7.5, 0}, {-15, 7.5, 0}}, true}};
  d.doors = {{"exit", {0, 0.5, 0}, {0, -0.5, 0}}};
  d.groups.resize(1);
  GroupDef& g = d.groups[0];
  g.count = 200, g.center = {-7.5, 0, 0}, g.half_extents = {7.1, 7.1, 0}, g.speed = speed;
  g.radius = 0.3, g.radius_deviation = 0.05;
  g.goal = {2, 0, 0}, g.goal_half_extents = {1, 1.5, 0}, g.leave = true;
  return d;
}

struct Exit {
  double flow, seconds;
};

/// People per second through the door until `most` have left, and when that was.
Exit out(const CrowdDef& d, double most) {
  CrowdRun run(d);
  for (int k = 0; k < 60 * 330 && run.state.f64(Columns::doors)[0] < most; ++k) run.step();
  return {run.observe("door.exit.flow"), static_cast<double>(run.steps) * run.h};
}
double flow(const CrowdDef& d, double most) {
  return out(d, most).flow;
}

/// How many have left by then.
double left(const CrowdDef& d, double seconds) {
  CrowdRun run(d);
  run.step(static_cast<uint64_t>(std::llround(seconds / run.h)));
  return run.state.f64(Columns::doors)[0];
}

TEST(CrowdValidation, TheFlowThroughADoorAtEase) {
  // Published: 0.73 people per second at 0.8 m/s through a door that is effectively 1 m wide, to which the
  // parameters were fitted. Starts with other seeds differ by 3 % (0.79 to 0.82); what "effectively"
  // subtracts from the width is not stated, and a clear width smaller by 0.1 m changes the flow by a quarter.
  EXPECT_NEAR(flow(room(0.8), 199), 0.73, 0.2 * 0.73);
  // Control: a door twice as wide.
  CrowdDef wide = room(0.8);
  wide.doors[0].from.y = 1, wide.doors[0].to.y = -1;
  EXPECT_GT(flow(wide, 199), 1.2 * 0.73);
}

TEST(CrowdValidation, ThoseWhoAgreeLeaveTooAndNobodyIsTouched) {
  CrowdDef d = room(1.34);
  d.model = Model::orca;
  CrowdRun run(d);
  double smallest = HUGE_VAL;
  for (int k = 0; k < 60 * 40; ++k) {
    run.step();
    if (k % 10 == 0) smallest = std::min(smallest, run.observe("separation.smallest"));
  }
  // Discs without friction pass about as fast as people with it: three starts give 1.1 to 1.3 per second.
  EXPECT_GT(run.observe("door.exit.flow"), 0.8);
  EXPECT_GT(smallest, -1e-9);
  // Control: with anticipation of everybody around, and half a second's distance from walls, they block the
  // door.
  d.max_neighbours = 24, d.wall_horizon = 0.5;
  CrowdRun stuck(d);
  stuck.step(60 * 40);
  EXPECT_LT(stuck.observe("left"), 0.7 * run.observe("left"));
}

TEST(CrowdValidation, FasterIsSlowerAtADoor) {
  // Figure 1 c: those who want to walk at 1.5 m/s are out first; faster ones press and rub.
  const Exit best = out(room(1.5), 60);
  EXPECT_GT(best.flow, 1.1 * flow(room(0.8), 60));
  EXPECT_LT(left(room(4), best.seconds), 60 / 1.2);
  // Control: without friction those who push harder are out sooner.
  CrowdDef smooth = room(4);
  smooth.sliding_friction = 0;
  EXPECT_GT(left(smooth, best.seconds), 60);
}

}  // namespace
}  // namespace truestep::crowd
