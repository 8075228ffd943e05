// Material added by nozzles and removed in kill regions.
#include <gtest/gtest.h>

#include "engine/core/state/state_check.h"
#include "tests/unit/mpm/mpm_rig.h"

namespace truestep::mpm {
namespace {

using testing_rig::MpmRun;

MpmDef jet(int dimension, Law law = Law::fluid) {
  MpmDef d;
  d.dimension = dimension, d.cell = 0.05;
  InletDef e;
  e.position = {0.5, 0.35, 0.5}, e.radius = 0.1, e.speed = 1, e.stop = 0.3, e.material = law;
  e.density = 900;
  d.emitters = {e};
  return d;
}

// As many particles as the nozzle's lattice, speed and time give, each with its share of the mass: layers 25
// mm apart, one every 25 ms, the first one born at 0.
TEST(MpmInlet, PoursWhatItsSpeedAndTimeSay) {
  for (const int dimension : {2, 3}) {
    for (const Law law : {Law::fluid, Law::snow, Law::sand}) {
      MpmRun run(jet(dimension, law), 0.01);
      const double layer = dimension == 2 ? 8 : 52, particle = 900 * (dimension == 2 ? 6.25e-4 : 1.5625e-5);
      EXPECT_EQ(static_cast<double>(run.system.setting().inlets[0].places.size()), layer);
      EXPECT_EQ(run.observe("mass"), 0);
      run.seconds(0.11);
      EXPECT_EQ(run.observe("count"), 5 * layer) << "born at 0, 25, 50, 75 and 100 ms";
      run.seconds(0.4);
      EXPECT_EQ(run.observe("count"), 12 * layer);
      EXPECT_EQ(run.observe("emitted"), run.observe("count"));
      if (law != Law::sand) {
        EXPECT_NEAR(run.observe("plastic.mean"), 0, 1e-3) << "nothing has deformed it yet";
      }
      // Sums in f64; each particle's mass is the density times its volume.
      EXPECT_NEAR(run.observe("mass") / (12 * layer * particle), 1, 1e-13);
      // Without gravity it keeps its velocity, up to rounding of f32 and the drag of nodes next to the axis.
      EXPECT_NEAR(run.observe("momentum.y") / run.observe("mass"), 1, 1e-3);
    }
  }
}

// Initial, added and removed material: every particle is counted once.
TEST(MpmInlet, MassIsBookedExactlyWhileItComesAndGoes) {
  MpmDef d = jet(2);
  d.precision = Precision::f64;
  d.emitters[0].stop.reset(), d.max_particles = 400;
  d.emitters[0].direction = {1, 0, 0}, d.emitters[0].position = {0.3, 0.8, 0};
  BodyDef block;
  block.center = {0.7, 0.2, 0}, block.half_extents = {0.1, 0.1, 1}, block.material = Law::sand;
  d.bodies = {block};
  d.kill_boxes = {
      {.center = {0.5, 0.75, 0}, .half_extents = {0.45, 0.2, 1}, .where = KillBoxDef::Where::inside}};
  d.kill_boxes[0].center = {0.9, 0.5, 0}, d.kill_boxes[0].half_extents = {0.1, 0.5, 1};
  MpmRun run(d, 0.01, {0, -9.81, 0});
  const double start = run.observe("count"), particle = 900 * 6.25e-4, grain = 1000 * 6.25e-4;
  EXPECT_EQ(start, 64);
  for (int k = 0; k < 100; ++k) {
    run.step();
    EXPECT_EQ(run.observe("count"), start + run.observe("emitted") - run.observe("killed"));
  }
  EXPECT_GT(run.observe("killed"), 50);
  double mass = 0;
  const auto pieces = run.state.span<uint32_t>(columns::piece);
  for (const uint32_t p : pieces) mass += p == 0 ? grain : particle;
  EXPECT_NEAR(run.observe("mass") / mass, 1, 1e-13);
  const auto ids = run.state.span<uint64_t>(columns::id);
  for (size_t k = 1; k < ids.size(); ++k) EXPECT_LT(ids[k - 1], ids[k]) << "ids in order, none twice";
  EXPECT_EQ(static_cast<double>(run.state.span<uint64_t>(columns::counts)[counts::born]),
            start + run.observe("emitted"));
  // Where there is no room left, births are refused and counted.
  d.kill_boxes.clear(), d.max_particles = 100;
  MpmRun full(d, 0.01, {0, -9.81, 0});
  full.seconds(0.5);
  EXPECT_EQ(full.observe("count"), 100);
  EXPECT_GT(full.observe("refused"), 50);
}

// Into a basin whose mouth is below what it has poured: nothing is doubled, whatever presses on it.
TEST(MpmInlet, PumpsUnderWhatIsThere) {
  MpmDef d = jet(2);
  d.bodies.resize(1);
  d.bodies[0].center = {0.5, 0.25, 0}, d.bodies[0].half_extents = {0.5, 0.25, 1},
  d.bodies[0].material = Law::fluid;
  d.emitters[0].position = {0.5, 0.15, 0}, d.emitters[0].speed = 0.3, d.emitters[0].stop.reset();
  MpmRun run(d, 1.0 / 60, {0, -9.81, 0});
  run.seconds(1);
  // 5 kPa of weight on a modulus of 100 kPa compress by 5 %.
  EXPECT_GT(run.observe("jacobian.min"), 0.85);
  EXPECT_FALSE(run.state.first_bad(4, State::Look::everything)) << "sqrt(2 g h) is 3.1 m/s";
}

TEST(MpmInlet, ComesAndGoesWithTheSameBits) {
  for (const Transfer transfer : {Transfer::apic, Transfer::flip}) {
    MpmDef d = jet(3, Law::snow);
    d.transfer = transfer, d.emitters[0].stop = 5;
    d.kill_planes = {{.point = {0, 0.6, 0}, .normal = {0, -1, 0}}};
    BodyDef block;
    block.center = {0.2, 0.2, 0.2}, block.material = Law::sand;
    d.bodies = {block};
    MpmRun one(d, 0.02, {0, -1, 0}, 1), three(d, 0.02, {0, -1, 0}, 3);
    one.step(20), three.step(20);
    EXPECT_EQ(one.state, three.state);
    MpmRun again(d, 0.02, {0, -1, 0}, 2);
    again.state = State::deserialize(one.state.serialize()), again.steps = one.steps;
    one.step(20), again.step(20);
    EXPECT_EQ(one.state, again.state) << "ids with them";
    EXPECT_GT(one.observe("killed"), 0);
    StateCheck fits(again.state, one.system.initial_state());
    one.system.check(fits, 0.8);
    EXPECT_NO_THROW(fits.finish());
    again.state.span<uint32_t>(columns::piece)[0] = 2;
    StateCheck wrong(again.state, one.system.initial_state());
    EXPECT_THROW(
        {
          one.system.check(wrong, 0.8);
          wrong.finish();
        },
        Error)
        << "there are two pieces";
  }
}

TEST(MpmInlet, SaysWhatDoesNotFit) {
  const auto fault = [](const MpmDef& d) {
    std::string out;
    mpm_table().check(&d, [&](const std::string& pointer, const std::string&) { out += pointer + ' '; });
    return out;
  };
  EXPECT_EQ(fault(jet(2)), "");
  MpmDef d = jet(2);
  d.emitters.clear();
  EXPECT_EQ(fault(d), "/bodies ");
  d = jet(2), d.emitters[0].position.y = 0.05;
  EXPECT_EQ(fault(d), "/emitters/0/position ") << "two cells behind it there is none";
  d = jet(2), d.emitters[0].radius = 0.001;
  EXPECT_EQ(fault(d), "/emitters/0/radius ");
  d = jet(2), d.emitters[0].direction = {0, 1, 1};
  EXPECT_EQ(fault(d), "/emitters/0/direction ");
  d = jet(2), d.exact = {"x", "y"};
  EXPECT_EQ(fault(d), "/exact ");
  d = jet(2), d.bodies.resize(1), d.bodies[0].center = {0.5, 0.5, 0}, d.max_particles = 10;
  EXPECT_EQ(fault(d), "/max_particles ");
}

}  // namespace
}  // namespace truestep::mpm
