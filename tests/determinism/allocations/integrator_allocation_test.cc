// Steps of force systems by every integrator, and of equations, allocate in the first step only.
#include <gtest/gtest.h>

#include "engine/integrators/table/integrators.h"
#include "engine/systems/mass_spring/mass_spring.h"
#include "engine/systems/mass_spring/mass_spring_def.h"
#include "engine/systems/ode/ode.h"
#include "tests/determinism/allocations/allocation_count.h"

namespace truestep {
using namespace mass_spring;
using namespace ode;
namespace {

TEST(Allocation, NoStepAfterTheFirstAllocates) {
  for (const Integrator& m : integrators()) {
    if (m.name.starts_with("cvode")) continue;  // allocates for every run, as its source says
    MassSpringDef d;
    d.cloth_grid.emplace();
    d.mass = 1e-3, d.stiffness = 50, d.internal_damping = m.order_with_velocity > 0 ? 1e-3 : 0;
    d.pins = {0};
    d.integrator = m.name;
    d.tolerance = 1e-5;
    const BuildContext context{.id = "cloth"};
    test::CountedSteps run(build_mass_spring(&d, context), 1.0 / 500);
    EXPECT_GT(run.steps(1), 0u) << m.name << ": the counter does not count";
    EXPECT_EQ(run.steps(19), 0u) << m.name;
  }
}

TEST(Allocation, StepsOfTheStiffestRopeAllocateNothingAfterTheFirst) {
  MassSpringDef d;
  d.rope = RopeShape{.from = {0, 1, 0}, .to = {1, 1, 0}, .links = 30};
  d.pinned = {"first"};
  d.mass = 0.01, d.stiffness = 1e12, d.internal_damping = 0.1;
  test::CountedSteps run(MassSpring::make(d, {}), 1.0 / 60);
  run.steps(1);
  EXPECT_EQ(run.steps(19), 0u);
}

// A rope that whips: the usual step gains energy late in the fall and is taken again with all of Newton's.
TEST(Allocation, RopesThatWhipAllocateNothingAfterTheFirstStep) {
  MassSpringDef d;
  d.rope = RopeShape{.from = {0, 1, 0}, .to = {-0.407, 2.731, -0.412}, .links = 30};
  d.pinned = {"first"};
  d.mass = 0.0733, d.stiffness = 6769;
  test::CountedSteps run(MassSpring::make(d, {.id = "s", .gravity = {0, -9.81, 0}, .dt = 1.0 / 30}),
                         1.0 / 30);
  run.steps(1);
  EXPECT_EQ(run.steps(44), 0u);
}

TEST(Allocation, EquationsEventsAndTracersAllocateNothingAfterTheFirstSteps) {
  OdeDef d;
  d.states = {{"h", {1}, NamedNumbers::Form::number}, {"v", {0}, NamedNumbers::Form::number}};
  d.equations = {{"h", "v"}, {"v", "-9.81 - 0.1 * sin(h)"}};
  OdeEventDef bounce, tick;
  bounce.when = "h", bounce.direction = OdeEventDef::Direction::falling, bounce.set = {{"v", "-0.9 * v"}};
  tick.every = 0.03;
  d.events = {bounce, tick};
  d.integrator = "dopri5";
  for (const bool with_tracers : {false, true}) {
    if (with_tracers) {
      d.tracers.emplace();
      d.tracers->velocity = {{"x", "y + h"}, {"y", "-sin(x)"}};
      d.tracers->count = 1000;
    }
    const BuildContext context{.id = "ode", .dt = 0.02};
    test::CountedSteps run(make_ode(&d, context), 0.02);
    // The first bounce comes in step 23.
    run.steps(30);
    EXPECT_EQ(run.steps(70), 0u) << with_tracers;
  }
}

}  // namespace
}  // namespace truestep
