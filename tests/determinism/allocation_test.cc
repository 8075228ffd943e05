// No step after the first allocates: a counting operator new watches the steps of every integrator.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "engine/core/medium.h"
#include "engine/geometry/solid.h"
#include "engine/integrators/table/integrators.h"
#include "engine/systems/articulation/articulation_def.h"
#include "engine/systems/mass_spring/mass_spring.h"
#include "engine/systems/mass_spring/mass_spring_def.h"
#include "engine/systems/ode/ode.h"
#include "engine/systems/skeleton/skeleton.h"
#include "engine/systems/xpbd/xpbd.h"
#include "tests/support/field_run.h"
#include "tests/support/grid_flow.h"
#include "tests/support/liquid_grid.h"
#include "tests/support/nbody_run.h"
#include "tests/support/shallow_run.h"
#include "tests/unit/crowd_rig.h"
#include "tests/unit/molecular_rig.h"
#include "tests/unit/mpm_rig.h"
#include "tests/unit/sph_rig.h"

namespace {
std::atomic<uint64_t> allocations{0};

void* counted(std::size_t size, std::size_t alignment) {
  ++allocations;
  void* p = nullptr;
  if (posix_memalign(&p, alignment, size) != 0) throw std::bad_alloc();
  return p;
}
}  // namespace

void* operator new(std::size_t size) {
  return counted(size, 16);
}
void* operator new(std::size_t size, std::align_val_t a) {
  return counted(size, static_cast<std::size_t>(a));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return counted(size, 16);
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}

namespace truestep {
using namespace articulation;
using namespace ode;
using namespace mass_spring;
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
    const auto system = build_mass_spring(&d, context);
    State s = system->initial_state();
    Workspace workspace;
    const ThreadArena arena(1);
    uint64_t first = 0, later = 0;
    for (uint64_t n = 0; n < 20; ++n) {
      const uint64_t before = allocations;
      system->step(s,
                   {.t = double(n) / 500, .h = 1.0 / 500, .step = n, .workspace = workspace, .arena = arena});
      (n == 0 ? first : later) += allocations - before;
    }
    EXPECT_GT(first, 0u) << m.name << ": the counter does not count";
    EXPECT_EQ(later, 0u) << m.name;
  }
}

TEST(Allocation, PositionBasedStepsAllocateNothingAfterTheFirst) {
  for (const xpbd::Precision precision : {xpbd::Precision::f64, xpbd::Precision::f32}) {
    xpbd::XpbdDef d;
    d.cloth_grid.emplace();
    d.flexural_rigidity = 1e-4, d.internal_damping = 1e-2, d.iterations = 2, d.precision = precision;
    d.colliders.push_back(PlaneColliderDef{{}, {0, -0.05, 0}});
    d.self_collision = true;
    const auto system = xpbd::build_xpbd(&d, {});
    State s = system->initial_state();
    Workspace workspace;
    const ThreadArena arena(1);
    uint64_t later = 0;
    for (uint64_t n = 0; n < 20; ++n) {
      const uint64_t before = allocations;
      system->step(s,
                   {.t = double(n) / 60, .h = 1.0 / 60, .step = n, .workspace = workspace, .arena = arena});
      if (n > 0) later += allocations - before;
    }
    EXPECT_EQ(later, 0u);
  }
}

TEST(Allocation, AtomsAllocateNothingAfterTheFirstStep) {
  using Method = molecular::ThermostatDef::Method;
  for (const Method method : {Method::velocity_rescaling, Method::langevin, Method::nose_hoover}) {
    molecular::MolecularDef d = testing_rig::liquid(6);
    d.thermostat = molecular::ThermostatDef{method, 1.4, 0.1, 3};
    d.barostat = molecular::BarostatDef{5, 1, 0.1, 10};
    testing_rig::AtomRun run(d, 0.005);
    run.step();
    const uint64_t before = allocations;
    // Within these steps the crystal melts and the neighbour list is rebuilt many times.
    run.step(100);
    EXPECT_EQ(allocations - before, 0u) << static_cast<int>(method);
  }
}

TEST(Allocation, ClothThatTearsAllocatesNothingAfterTheFirstStep) {
  for (const xpbd::Precision precision : {xpbd::Precision::f64, xpbd::Precision::f32}) {
    xpbd::XpbdDef d;
    d.cloth_grid.emplace();
    d.flexural_rigidity = 1e-4, d.internal_damping = 1e-2, d.iterations = 2, d.precision = precision;
    d.stiffness = 10, d.pinned = {"edge_v0"}, d.tear = xpbd::TearDef{.strain = 0.1};
    const auto system = xpbd::build_xpbd(&d, {});
    State s = system->initial_state();
    Workspace workspace;
    const ThreadArena arena(1);
    const size_t points = s.rows(0);
    uint64_t later = 0;
    for (uint64_t n = 0; n < 40; ++n) {
      const uint64_t before = allocations;
      system->step(s,
                   {.t = double(n) / 60, .h = 1.0 / 60, .step = n, .workspace = workspace, .arena = arena});
      if (n > 0) later += allocations - before;
    }
    EXPECT_GT(s.rows(0), points);
    EXPECT_EQ(later, 0u);
  }
}

TEST(Allocation, SoftBlocksAllocateNothingAfterTheFirstStep) {
  for (const bool matched : {true, false}) {
    xpbd::XpbdDef d;
    d.block.emplace(), d.copies.resize(2), d.copies[1].position = {3, 0, 0};
    d.iterations = 2;
    if (matched) {
      d.matching = xpbd::MatchDef{.frequency = 3, .linear = 0.5};
    } else {
      d.youngs_modulus = 1e4;
    }
    const auto system = xpbd::build_xpbd(&d, {});
    State s = system->initial_state();
    Workspace workspace;
    const ThreadArena arena(1);
    uint64_t later = 0;
    for (uint64_t n = 0; n < 10; ++n) {
      const uint64_t before = allocations;
      system->step(s,
                   {.t = double(n) / 60, .h = 1.0 / 60, .step = n, .workspace = workspace, .arena = arena});
      if (n > 0) later += allocations - before;
    }
    EXPECT_EQ(later, 0u);
  }
}

TEST(Allocation, TreesOfLinksAllocateNothingAfterTheFirstStep) {
  ArticulationDef d;
  LinkDef link;
  link.joint = JointType::spherical, link.mass = 1, link.center = {0, -0.5, 0},
  link.inertia = {0.1, 0.01, 0.1};
  link.id = "chain", link.copies = LinkCopiesDef{20, {0, -1, 0}}, link.rotation = {0, 0, 1};
  d.links.push_back(link);
  d.closures.push_back({"chain", "ground", {0, -1, 0}, {16, -10.5, 0}});
  d.springs.push_back({"chain", "ground", {0, -0.5, 0}, {0, -10, 0}, 10, 1, 3});
  for (const char* method : {"rk4", "dop853"}) {
    d.integrator = method;
    const auto system = build_articulation(&d, {});
    State s = system->initial_state();
    Workspace workspace;
    const ThreadArena arena(1);
    const auto step = [&](uint64_t n) {
      system->step(s,
                   {.t = double(n) / 100, .h = 1.0 / 100, .step = n, .workspace = workspace, .arena = arena});
    };
    step(0);
    const uint64_t before = allocations;
    for (uint64_t n = 1; n < 20; ++n) step(n);
    EXPECT_EQ(allocations - before, 0u) << method;
  }
}

TEST(Allocation, ImplicitStepsOfLinksAllocateNothingAfterTheFirst) {
  ArticulationDef d;
  LinkDef link;
  link.joint = JointType::spherical, link.mass = 1, link.center = {0, -0.5, 0},
  link.inertia = {0.1, 0.01, 0.1};
  link.copies = LinkCopiesDef{20, {0, -1, 0}}, link.rotation = {0, 0, 0.1}, link.stiffness = 50;
  link.force = {1, 0, 0};
  d.links.push_back(link);
  for (const char* method : {"implicit_euler", "linear_implicit_euler", "trapezoid", "bdf2", "tr_bdf2",
                             "sdirk4", "rodas5p", "radau5"}) {
    d.integrator = method;
    const auto system = build_articulation(&d, {});
    State s = system->initial_state();
    Workspace workspace;
    const ThreadArena arena(1);
    const auto step = [&](uint64_t n) {
      system->step(s,
                   {.t = double(n) / 100, .h = 1.0 / 100, .step = n, .workspace = workspace, .arena = arena});
    };
    step(0);
    const uint64_t before = allocations;
    for (uint64_t n = 1; n < 20; ++n) step(n);
    EXPECT_EQ(allocations - before, 0u) << method;
  }
}

TEST(Allocation, HeatAndWavesAllocateNothingAfterTheFirstSteps) {
  const auto expect_none = [](const auto& def, const char* what) {
    test::FieldRun run(def, 1e-3);
    run.steps(2);
    const uint64_t before = allocations;
    run.steps(10);
    EXPECT_EQ(allocations - before, 0u) << def.integrator << " " << what;
  };
  const auto fill = [](auto& d) {
    d.cells = {24, 20};
    d.initial = "x*y";
    d.source = "sin(t)*x";
    d.sides.x_min = test::side(lattice::SideKind::dirichlet, "sin(t)");
    d.sides.x_max = test::side(lattice::SideKind::neumann, "y*t");
    d.tolerance = 1e-4;
  };
  for (const char* method : {"euler", "rk4", "rkc2", "trapezoid", "bdf2", "sdirk4", "rodas5p", "radau5"}) {
    heat::HeatDef d;
    fill(d);
    d.integrator = method;
    expect_none(d, "by waves");
    d.diffusivity = "1 + x";
    expect_none(d, "by multigrid");
  }
  for (const char* method : {"leapfrog", "implicit_midpoint", "generalized_alpha"}) {
    wave::WaveDef d;
    fill(d);
    d.integrator = method;
    expect_none(d, "waves");
  }
}

// Neighbours come and go: lists may grow while a column falls, but not once it is at rest.
TEST(Allocation, LiquidsAtRestAndBodiesInThemAllocateNothing) {
  for (const sph::Method solver : {sph::Method::dfsph, sph::Method::wcsph, sph::Method::pbf}) {
    sph::SphDef d;
    d.solver = solver, d.spacing = 0.05, d.viscosity = 1e-3;
    d.bodies = {{.center = {0.5, 0.2, 0.5}, .half_extents = {0.5, 0.2, 0.5}}};
    d.hollows = {{.shape = sph::Shape::ball, .center = {0.5, 0.4, 0.5}, .radius = 0.15}};
    testing_rig::SphRun run(d, 1.0 / 120, {0, -9.81, 0});
    const Solid ball = sphere_solid(0.15);
    std::vector<ImmersedBody> bodies(1);
    bodies[0].solid = &ball, bodies[0].mass = 7, bodies[0].moments = Vec3{1, 1, 1} * (0.4 * 7 * 0.0225);
    bodies[0].place = {0.5, 0.4, 0.5};
    const auto step = [&] { run.step(1, bodies); };
    for (int k = 0; k < 20; ++k) step();
    const uint64_t before = allocations;
    for (int k = 0; k < 10; ++k) step();
    EXPECT_EQ(allocations - before, 0u) << static_cast<int>(solver);
    EXPECT_NE(bodies[0].impulse.y, 0) << "control: the ball is in the water";
  }
}

// A block that breaks apart, with a ball in it: more blocks of cells are in use than at the start.
TEST(Allocation, StepsOfMaterialAllocateNothingAfterTheFirst) {
  const Solid ball = sphere_solid(0.1);
  for (const mpm::Transfer transfer : {mpm::Transfer::apic, mpm::Transfer::flip}) {
    mpm::MpmDef d;
    d.dimension = 3, d.cell = 0.05, d.transfer = transfer;
    mpm::BodyDef piece;
    piece.center = {0.3, 0.3, 0.5}, piece.half_extents = {0.2, 0.3, 0.3}, piece.velocity = {3, 0, 0};
    piece.material = mpm::Law::sand;
    d.bodies = {piece};
    d.bodies.push_back({{.material = mpm::Law::fluid}, mpm::Shape::box, {0.8, 0.1, 0.5}, {0.1, 0.1, 0.3}});
    testing_rig::MpmRun run(d, 1.0 / 120, {0, -9.81, 0});
    std::vector<ImmersedBody> bodies(1);
    bodies[0].solid = &ball, bodies[0].mass = 7, bodies[0].moments = Vec3{1, 1, 1} * (0.4 * 7 * 0.01);
    bodies[0].place = {0.4, 0.55, 0.5};
    const auto step = [&] { run.step(1, bodies); };
    step();
    const double width = run.observe("high.x");
    const uint64_t before = allocations;
    for (int k = 0; k < 20; ++k) step();
    EXPECT_EQ(allocations - before, 0u) << static_cast<int>(transfer);
    EXPECT_GT(run.observe("high.x"), std::min(0.95, width)) << "control: it moves";
    EXPECT_NE(bodies[0].impulse.x, 0) << "control: the ball is in the sand";
  }
}

// Contact that begins long after the first step, and the implicit step's solves.
TEST(Allocation, FieldsThatMeetAndImplicitStepsAllocateNothingAfterTheFirst) {
  for (const bool implicit : {false, true}) {
    mpm::MpmDef d;
    d.precision = mpm::Precision::f64, d.cell = 1.0 / 32;
    mpm::BodyDef piece;
    piece.center = {0.3, 0.12, 0}, piece.half_extents = {0.1, 0.1, 1}, piece.youngs_modulus = 1e6;
    d.bodies = {piece, piece};
    d.bodies[1].center.x = 0.7, d.bodies[1].velocity.x = -2;
    if (implicit) d.integration = mpm::Integration::implicit_steps;
    if (!implicit) d.bodies[1].velocity_field = 1;
    testing_rig::MpmRun run(d, 1.0 / 120, {0, -9.81, 0});
    run.step();
    const uint64_t before = allocations;
    run.step(20);
    EXPECT_EQ(allocations - before, 0u) << implicit;
    EXPECT_LT(run.velocity(0).x, -0.05) << "control: they have met";
  }
}

TEST(Allocation, StepsOfBodiesAllocateNothingAfterTheFirst) {
  using nbody::Method;
  for (const Method method : {Method::direct, Method::tree, Method::fmm}) {
    nbody::NbodyDef d = testing_rig::model_units();
    d.groups = {nbody::PlummerDef{.count = 2000}};
    d.softening = 0.05, d.radius = 1e-3, d.method = method;
    d.collisions = nbody::CollisionsDef{nbody::Response::bounce, 0.5};
    testing_rig::NbodyRun run(d, 0.02);
    run.step(3);
    const uint64_t before = allocations;
    run.step(10);
    EXPECT_EQ(allocations - before, 0u) << static_cast<int>(method);
  }
}

TEST(Allocation, StepsOfAFlowOnAGridAllocateNothingAfterTheFirst) {
  using grid_fluid::GridFluidDef;
  for (const bool solid : {false, true}) {
    for (const auto advection : {GridFluidDef::Advection::central, GridFluidDef::Advection::maccormack}) {
      GridFluidDef d;
      d.cells = {24, 20};
      d.viscosity = 0.1;
      d.advection = advection;
      d.scalar =
          grid_fluid::ScalarDef{.initial = "x", .source = "sin(t)*x", .diffusivity = 0.01, .expansion = 0.1};
      d.force = {"sin(t)", "0"};
      d.sides.y_max = grid_fluid::FlowSideDef{grid_fluid::SideKind::wall, {"cos(t)", "0"}};
      if (solid) d.obstacles = {grid_fluid::ObstacleDef{.center = {0.5, 0.5, 0}, .radius = 0.2}};
      test::GridFlow run(d, 0.01);
      run.steps(2);
      const uint64_t before = allocations;
      run.steps(5);
      EXPECT_EQ(allocations - before, 0u) << solid;
    }
  }
}

TEST(Allocation, StepsOfALiquidOnAGridAllocateNothingAfterTheFirst) {
  using grid_fluid::GridFluidDef;
  for (const bool space : {false, true}) {
    for (const auto advection : {GridFluidDef::Advection::flip, GridFluidDef::Advection::apic}) {
      GridFluidDef d = test::water(
          advection, space ? std::vector<int64_t>{16, 12, 8} : std::vector<int64_t>{32, 24}, 1.0 / 24);
      d.bodies = {test::box_of_liquid({0, 0, -1}, {0.25, 0.4, 1})};
      d.obstacles = {grid_fluid::ObstacleDef{.center = {0.4, 0, 0.2}, .radius = 0.1}};
      d.force = {"sin(t)", "0"};
      if (space) d.force.emplace_back("0");
      test::LiquidRun run(d, 0.01);
      run.steps(2);
      const uint64_t before = allocations;
      run.steps(10);
      EXPECT_EQ(allocations - before, 0u) << space;
    }
  }
}

TEST(Allocation, StepsOfShallowWaterAllocateNothingAfterTheFirst) {
  for (const size_t dimensions : {1, 2}) {
    heightfield_wave::HeightfieldWaveDef d;
    d.cells.assign(dimensions, 24);
    d.surface = "x < 0.5 ? 1 : 0";
    d.friction = 0.01;
    test::ShallowRun run(d, 0.05);
    run.steps(2);
    const uint64_t before = allocations;
    run.steps(5);
    EXPECT_EQ(allocations - before, 0u) << dimensions;
  }
}

TEST(Allocation, StepsOfTheStiffestRopeAllocateNothingAfterTheFirst) {
  MassSpringDef d;
  d.rope = RopeShape{.from = {0, 1, 0}, .to = {1, 1, 0}, .links = 30};
  d.pinned = {"first"};
  d.mass = 0.01, d.stiffness = 1e12, d.internal_damping = 0.1;
  const auto system = MassSpring::make(d, {});
  State s = system->initial_state();
  Workspace workspace;
  const ThreadArena arena(1);
  const auto step = [&](uint64_t n) {
    system->step(s, {.t = double(n) / 60, .h = 1.0 / 60, .step = n, .workspace = workspace, .arena = arena});
  };
  step(0);
  const uint64_t before = allocations;
  for (uint64_t n = 1; n < 20; ++n) step(n);
  EXPECT_EQ(allocations - before, 0u);
}

// A rope that whips: the usual step gains energy late in the fall and is taken again with all of Newton's.
TEST(Allocation, RopesThatWhipAllocateNothingAfterTheFirstStep) {
  MassSpringDef d;
  d.rope = RopeShape{.from = {0, 1, 0}, .to = {-0.407, 2.731, -0.412}, .links = 30};
  d.pinned = {"first"};
  d.mass = 0.0733, d.stiffness = 6769;
  const auto system = MassSpring::make(d, {.id = "s", .gravity = {0, -9.81, 0}, .dt = 1.0 / 30});
  State s = system->initial_state();
  Workspace workspace;
  const ThreadArena arena(1);
  const auto step = [&](uint64_t n) {
    system->step(s, {.t = double(n) / 30, .h = 1.0 / 30, .step = n, .workspace = workspace, .arena = arena});
  };
  step(0);
  const uint64_t before = allocations;
  for (uint64_t n = 1; n < 45; ++n) step(n);
  EXPECT_EQ(allocations - before, 0u);
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
    const auto system = make_ode(&d, context);
    State s = system->initial_state();
    Workspace workspace;
    const ThreadArena arena(1);
    const auto step = [&](uint64_t n) {
      system->step(
          s,
          {.t = static_cast<double>(n) * 0.02, .h = 0.02, .step = n, .workspace = workspace, .arena = arena});
    };
    // The first bounce comes in step 23.
    for (uint64_t n = 0; n < 30; ++n) step(n);
    const uint64_t before = allocations;
    for (uint64_t n = 30; n < 100; ++n) step(n);
    EXPECT_EQ(allocations - before, 0u) << with_tracers;
  }
}

TEST(Allocation, CrowdsThatLeaveAllocateNothingAfterTheFirstStep) {
  for (const crowd::Model model : {crowd::Model::social_force, crowd::Model::orca}) {
    crowd::CrowdDef d;
    d.model = model, d.noise = 0.1, d.walls = {{{{-5, -5, 0}, {0, -5, 0}, {0, 5, 0}, {-5, 5, 0}}, true}};
    d.doors = {{"exit", {0, 1, 0}, {0, -1, 0}}};
    d.groups.resize(1);
    crowd::GroupDef& g = d.groups[0];
    g.count = 60, g.center = {-2.5, 0, 0}, g.half_extents = {2.2, 4.5, 0}, g.radius = 0.2;
    g.goal = {3, 0, 0}, g.leave = true;
    testing_rig::CrowdRun run(d);
    run.step();
    const uint64_t before = allocations;
    run.step(360);
    EXPECT_EQ(allocations - before, 0u) << static_cast<int>(model);
    EXPECT_LT(run.people(), 60u);
  }
}

TEST(Allocation, SkeletonsThatReachAllocateNothingAfterTheFirstStep) {
  using animation::IkMethod;
  for (const IkMethod method : {IkMethod::gradient, IkMethod::gauss_newton, IkMethod::damped_least_squares,
                                IkMethod::ccd, IkMethod::fabrik}) {
    skeleton::SkeletonDef d;
    d.solver = method;
    d.controls.resize(2);
    d.controls[0].name = "a", d.controls[0].value = "sin(3*t)";
    d.controls[1].name = "b", d.controls[1].times = {0, 1}, d.controls[1].values = {0, 1};
    for (int j = 0; j < 8; ++j) {
      skeleton::JointDef joint;
      joint.id = std::to_string(j);
      if (j > 0) joint.parent = std::to_string(j - 1), joint.offset = {0.2, 0, 0};
      joint.end = Vec3{0.2, 0, 0};
      d.joints.push_back(joint);
    }
    d.goals.resize(1);
    d.goals[0].joint = "7", d.goals[0].target = {"0.6 + 0.3*a", "0.5 + b", "0.2"};
    d.skin.emplace();
    d.skin->tubes = {{"0", "7", 0.1, {}, 16, 12}};
    const auto system = skeleton::build_skeleton(&d, {});
    State s = system->initial_state();
    Workspace workspace;
    const ThreadArena arena(1);
    const auto step = [&](uint64_t n) {
      system->step(s,
                   {.t = double(n) / 60, .h = 1.0 / 60, .step = n, .workspace = workspace, .arena = arena});
    };
    step(0);
    const uint64_t before = allocations;
    for (uint64_t n = 1; n < 60; ++n) step(n);
    EXPECT_EQ(allocations - before, 0u) << static_cast<int>(method);
  }
}

}  // namespace
}  // namespace truestep
