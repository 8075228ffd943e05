// Every integrator gives the same bits on a cloth of 4,900 points for any number of threads, with a discarded
// workspace, with another state in between, and from a restored snapshot.
#include <gtest/gtest.h>

#include <cstring>

#include "engine/integrators/table/integrators.h"
#include "engine/systems/mass_spring/mass_spring.h"
#include "engine/systems/mass_spring/mass_spring_def.h"

namespace truestep {
using namespace mass_spring;
namespace {

std::unique_ptr<const System> cloth(std::string_view integrator, double internal_damping = 1e-3,
                                    int side = 70) {
  MassSpringDef d;
  d.cloth_grid.emplace();
  d.cloth_grid->nx = d.cloth_grid->ny = side;
  d.mass = 1e-3, d.stiffness = 50, d.shear_stiffness = 30, d.bending_stiffness = 5,
  d.internal_damping = internal_damping;
  d.pins = {0, side - 1};
  d.integrator = integrator;
  d.tolerance = 1e-5, d.newton_tolerance = 1e-6;
  const BuildContext context{.id = "cloth"};
  return build_mass_spring(&d, context);
}

struct Stepper {
  const System& system;
  Workspace workspace;
  ThreadArena arena;
  Stepper(const System& s, int threads) : system(s), arena(threads) {}
  void step(State& s, uint64_t n) {
    const double h = 1.0 / 500;
    system.step(s, {.t = double(n) * h, .h = h, .step = n, .workspace = workspace, .arena = arena});
  }
};

constexpr uint64_t kSteps = 6;

class Bits : public ::testing::TestWithParam<std::string> {};

TEST_P(Bits, DoNotDependOnHowTheRunIsMade) {
  // Damping makes the force depend on velocity, which some methods refuse.
  const Integrator& method = *find_integrator(GetParam());
  const bool damped = method.order_with_velocity > 0;
  // Methods that factorize the whole Jacobian in every step run on 256 points: they do not use several
  // threads. Implicit Euler is solved block by block, by several.
  const bool blocks = method.name == "implicit_euler" || method.name == "linear_implicit_euler";
  const bool factorises = method.kind == Integrator::Kind::implicit && method.advance && !blocks;
  const auto system = cloth(GetParam(), damped ? 1e-3 : 0, factorises ? 16 : 70);
  Stepper one(*system, 1);
  State reference = system->initial_state();
  std::vector<std::byte> snapshot;
  for (uint64_t n = 0; n < kSteps; ++n) {
    if (n == kSteps / 2) snapshot = reference.serialize();
    one.step(reference, n);
  }
  ASSERT_FALSE(reference == system->initial_state());
  for (const int threads : {2, 4}) {
    Stepper many(*system, threads);
    State s = system->initial_state();
    for (uint64_t n = 0; n < kSteps; ++n) many.step(s, n);
    EXPECT_EQ(s.hash(), reference.hash()) << threads << " threads";
  }
  {
    Stepper forgetful(*system, 1);
    State s = system->initial_state();
    for (uint64_t n = 0; n < kSteps; ++n) {
      forgetful.workspace.clear();
      forgetful.step(s, n);
    }
    EXPECT_EQ(s.hash(), reference.hash()) << "workspace dropped";
  }
  {
    Stepper shared(*system, 1);
    State a = system->initial_state(), b = system->initial_state();
    b.f64(b.at("velocity"))[100] += 0.5;
    for (uint64_t n = 0; n < kSteps; ++n) {
      shared.step(a, n);
      shared.step(b, n);
    }
    EXPECT_EQ(a.hash(), reference.hash()) << "another state in between";
    EXPECT_NE(b.hash(), reference.hash());
  }
  {
    Stepper restored(*system, 1);
    State s = State::deserialize(snapshot);
    for (uint64_t n = kSteps / 2; n < kSteps; ++n) restored.step(s, n);
    EXPECT_EQ(s.hash(), reference.hash()) << "restored";
  }
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const Integrator& m : integrators()) all.emplace_back(m.name);
  return all;
}
INSTANTIATE_TEST_SUITE_P(Integrators, Bits, ::testing::ValuesIn(names()),
                         [](const auto& info) { return info.param; });

TEST(VelocityVerlet, KeepsNoForceThatACommandHasChanged) {
  const auto system = cloth("velocity_verlet", 0);
  Stepper keeping(*system, 1), forgetful(*system, 1);
  State a = system->initial_state(), b = a;
  for (uint64_t n = 0; n < 12; ++n) {
    for (State* s : {&a, &b}) {
      if (n == 3) s->f64(s->at("gravity"))[1] = -2;
      if (n == 6) s->f64(s->at("position"))[3 * 2000 + 1] += 1e-3;
      if (n == 9) s->f64(s->at("velocity"))[3 * 2000 + 1] += 0.1;
    }
    forgetful.workspace.clear();
    keeping.step(a, n);
    forgetful.step(b, n);
    ASSERT_EQ(a.hash(), b.hash()) << "step " << n;
  }
}

TEST(Verlet, SurvivesCommandsBetweenSteps) {
  // A velocity kick must act as in velocity_verlet: both are of second order, so the paths differ by O(h^2);
  // losing the kick would separate them by 0.5 m/s times the time.
  const auto a = cloth("verlet"), b = cloth("velocity_verlet");
  Stepper sa(*a, 1), sb(*b, 1);
  State x = a->initial_state(), y = b->initial_state();
  for (uint64_t n = 0; n < 20; ++n) {
    if (n == 10) {
      for (State* s : {&x, &y}) {
        s->f64(s->at("velocity"))[3 * 2000 + 1] += 0.5;
        s->f64(s->at("position"))[3 * 1000 + 1] += 1e-3;
      }
    }
    sa.step(x, n);
    sb.step(y, n);
  }
  const auto px = x.f64(x.at("position")), py = y.f64(y.at("position"));
  double worst = 0;
  for (size_t i = 0; i < px.size(); ++i) worst = std::max(worst, std::abs(px[i] - py[i]));
  EXPECT_LT(worst, 5e-4);
  EXPECT_GT(std::abs(py[3 * 2000 + 1] - py[3 * 2010 + 1]), 1e-3);
}

}  // namespace
}  // namespace truestep
