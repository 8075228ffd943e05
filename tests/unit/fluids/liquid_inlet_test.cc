// Liquid of flip and apic that nozzles pour and kill regions remove.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/core/state/state_check.h"
#include "tests/support/fluids/liquid_grid.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;
using A = GridFluidDef::Advection;

LiquidInletDef upwards(const Vec3& position, double radius, double speed) {
  LiquidInletDef e;
  e.position = position, e.radius = radius, e.speed = speed;
  return e;
}

// An empty box of a metre, cells of 0.05 m, and a nozzle that pours upwards for 0.3 s.
GridFluidDef liquid_jet(A advection, size_t dimensions) {
  GridFluidDef d = water(advection, std::vector<int64_t>(dimensions, 20), 0.05);
  d.emitters = {upwards({0.5, 0.35, 0.5}, 0.1, 1)};
  d.emitters[0].stop = 0.3;
  return d;
}

double particle_volume(const GridFluidDef& d) {
  return d.cells.size() == 2 ? 6.25e-4 : 1.5625e-5;
}

// Layers 25 mm apart, one every 25 ms, the first one at 0.
TEST(LiquidInlet, PoursWhatItsSpeedAndTimeSay) {
  for (const A advection : {A::flip, A::apic}) {
    for (const size_t dimensions : {2, 3}) {
      const GridFluidDef d = liquid_jet(advection, dimensions);
      LiquidRun run(d, 0.01, 1, {});
      const double layer = dimensions == 2 ? 8 : 52;
      EXPECT_EQ(run.observed("count"), 0);
      run.steps(11);
      EXPECT_EQ(run.observed("count"), 5 * layer) << "born at 0, 25, 50, 75 and 100 ms";
      run.steps(40);
      EXPECT_EQ(run.observed("count"), 12 * layer);
      EXPECT_EQ(run.observed("emitted"), 12 * layer);
      EXPECT_NEAR(run.observed("mass"), 12 * layer * 1000 * particle_volume(d), 1e-9);
      // Without gravity a free jet keeps its velocity: what its sides exchange with air is nothing.
      EXPECT_NEAR(run.observed("momentum.y") / run.observed("mass"), 1, 0.01);
      // From 0.25 m, where the nozzle's back is, the first layer has come 0.51 m far.
      EXPECT_NEAR(run.observed("high.y"), 0.76, 0.0125) << "half a particle";
    }
  }
}

// A nozzle under the water of a pool, along the grid and across it: the level rises by what it pours, and
// nothing is compressed.
TEST(LiquidInlet, FillsAPoolFromBelow) {
  for (const A advection : {A::flip, A::apic}) {
    for (const double across : {0, 1}) {
      GridFluidDef d = water(advection, {40, 40}, 0.025);
      d.bodies = {box_of_liquid({0, 0, -1}, {1, 0.3, 1})};
      d.emitters = {upwards({0.45, 0.12, 0}, 0.1, 0.5)};
      d.emitters[0].direction.x = across;
      LiquidRun run(d, 0.01);
      run.steps(200);
      // 16 places, 12.5 mm apart: 0.2 m wide. A layer more or less.
      const double poured = 0.2 * 0.5 * 2, layer = 0.2 * 0.0125;
      EXPECT_NEAR(run.observed("mass") / 1000, 0.3 + poured, 1.5 * layer);
      // 0.5 m deep; case fluid.hydrostatic's 2 %, waves included. A compressed pool would be 40 % lower.
      EXPECT_NEAR(run.observed("centre.y"), run.observed("mass") / 2000, 0.02 * 0.25);
      EXPECT_LT(run.observed("density.mean_error"), 0.05);
      EXPECT_GT(run.observed("speed.max"), 0.4) << "control: the jet is under way";
    }
  }
}

// Where one of them is, and how many there were, are always known.
TEST(LiquidInlet, CountsEveryParticleOnce) {
  for (const size_t dimensions : {2, 3}) {
    GridFluidDef d = liquid_jet(A::flip, dimensions);
    d.emitters[0].stop.reset(), d.emitters[0].direction = {1, 0, 0}, d.emitters[0].position = {0.2, 0.8, 0.5};
    d.emitters.push_back(upwards({0.8, 0.2, 0.5}, 0.06, 0.7));
    d.bodies = {box_of_liquid({0.1, 0, 0.2}, {0.5, 0.2, 0.8})};
    d.kill_planes = {{.point = {0, 0.02, 0}, .normal = {0, 1, 0}}};
    d.kill_boxes = {
        {.center = {0.9, 0.5, 0.5}, .half_extents = {0.1, 0.5, 1}, .where = KillBoxDef::Where::inside}};
    LiquidRun run(d, 0.01);
    const double start = run.observed("count");
    for (int k = 0; k < 60; ++k) {
      run.steps(1);
      EXPECT_EQ(run.observed("count"), start + run.observed("emitted") - run.observed("killed"));
    }
    EXPECT_GT(run.observed("killed"), 20);
    EXPECT_EQ(run.observed("refused"), 0);
    std::vector<double> scratch;
    const FieldView id = run.system->field(run.state, 0, 5, scratch);
    ASSERT_EQ(id.rows, static_cast<size_t>(run.observed("count")));
    const auto* ids = static_cast<const uint64_t*>(id.data);
    EXPECT_TRUE(std::is_sorted(ids, ids + id.rows)) << "rows of those that went are closed up";
    EXPECT_EQ(std::adjacent_find(ids, ids + id.rows), ids + id.rows) << "none twice";
    EXPECT_LT(ids[id.rows - 1], start + run.observed("emitted"));
  }
  // Where there is no room left, births are refused and counted; the others move on.
  GridFluidDef d = liquid_jet(A::apic, 2);
  d.emitters[0].stop.reset(), d.max_particles = 100;
  LiquidRun full(d, 0.01);
  full.steps(60);
  EXPECT_EQ(full.observed("count"), 100);
  EXPECT_GT(full.observed("refused"), 50);
  EXPECT_EQ(full.system->parts()[0].max_rows, 100u);
}

TEST(LiquidInlet, CarriesItsDye) {
  for (const size_t dimensions : {2, 3}) {
    GridFluidDef d = liquid_jet(A::apic, dimensions);
    d.bodies = {box_of_liquid({0, 0, -1}, {1, 0.2, 1}), box_of_liquid({0, 0.2, -1}, {0.5, 0.25, 1})};
    d.bodies[1].dye = 3, d.emitters[0].dye = -2;
    LiquidRun run(d, 0.01);
    const double volume = particle_volume(d), dyed = dimensions == 2 ? 0.025 : 0.025;
    EXPECT_NEAR(run.observed("dye.total"), 3 * dyed, 1e-12);
    run.steps(40);
    EXPECT_NEAR(run.observed("dye.total"), 3 * dyed - 2 * volume * run.observed("emitted"), 1e-12);
    std::vector<double> scratch;
    ASSERT_EQ(run.system->parts()[0].fields[5].name, "dye");
    const FieldView dye = run.system->field(run.state, 0, 5, scratch);
    const auto* q = static_cast<const double*>(dye.data);
    const auto count = [&](double value) { return double(std::count(q, q + dye.rows, value)); };
    EXPECT_EQ(count(-2), run.observed("emitted"));
    EXPECT_NEAR(count(3) * volume, dyed, 1e-12);
    EXPECT_EQ(count(-2) + count(3) + count(0), double(dye.rows)) << "particles keep it to the bit";
  }
}

TEST(LiquidInlet, StatesThatNoRunLeadsToAreRefused) {
  const GridFluidDef d = liquid_jet(A::apic, 2);
  LiquidRun run(d, 0.01);
  run.steps(20);
  const State start = run.system->initial_state();
  const auto accepts = [&](const State& s) {
    try {
      StateCheck check(s, start);
      run.system->check(check, run.t());
      check.finish();
    } catch (const Error&) {
      return false;
    }
    return true;
  };
  EXPECT_TRUE(accepts(run.state));
  State short_of_one = run.state;
  short_of_one.resize(1, short_of_one.rows(0) - 1);
  EXPECT_FALSE(accepts(short_of_one)) << "a velocity is missing";
  State late = run.state;
  late.span<uint64_t>(late.at("emitter.next_layer"))[0] = UINT64_MAX;
  EXPECT_FALSE(accepts(late)) << "layers that nobody will see";
}

TEST(LiquidInlet, SaysWhatDoesNotFit) {
  const auto fault = [](const GridFluidDef& d) {
    std::string out;
    grid_fluid_table().check(&d,
                             [&](const std::string& pointer, const std::string&) { out += pointer + ' '; });
    return out;
  };
  GridFluidDef d = liquid_jet(A::apic, 2);
  EXPECT_EQ(fault(d), "");
  d.emitters.clear();
  EXPECT_EQ(fault(d), "/bodies ");
  d = liquid_jet(A::apic, 2), d.emitters[0].position.y = 0.08;
  EXPECT_EQ(fault(d), "/emitters/0/position ") << "two cells behind it there is none";
  d = liquid_jet(A::apic, 2), d.emitters[0].radius = 0.001;
  EXPECT_EQ(fault(d), "/emitters/0/radius ");
  d = liquid_jet(A::apic, 2), d.emitters[0].direction = {0, 1, 1};
  EXPECT_EQ(fault(d), "/emitters/0/direction ");
  d = liquid_jet(A::apic, 2), d.bodies = {box_of_liquid({0, 0, -1}, {1, 0.2, 1})}, d.max_particles = 10;
  EXPECT_EQ(fault(d), "/max_particles ");
  d = liquid_jet(A::apic, 2), d.all->dye = 1;
  EXPECT_EQ(fault(d), "/side/dye /side/dye /side/dye /side/dye ") << "walls let nothing in";
  d = liquid_jet(A::central, 2);
  EXPECT_EQ(fault(d), "/emitters ");
  d.emitters.clear(), d.kill_planes.resize(1), d.kill_boxes.resize(1), d.max_particles = 5;
  EXPECT_EQ(fault(d), "/kill_planes /kill_boxes /max_particles ");
}

}  // namespace
}  // namespace truestep::test
