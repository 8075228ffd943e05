// Bending stiffness in physical units, and the forces in pins: cantilevers against Euler and Bernoulli, a
// plate's stiffness in every direction, the weight carried by pins.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/text/short_number.h"
#include "engine/scene/json/json.h"
#include "engine/session/world/world.h"
#include "engine/systems/mass_spring/mass_spring_field.h"

namespace truestep {
using namespace mass_spring;
namespace {

struct Rest {
  // Damped until nothing moves.
  explicit Rest(const std::string& system, double gravity, int steps, double dt)
      : world(parse_scene(R"({"gravity": [0, )" + std::to_string(-gravity) + R"(, 0], "time": {"dt": )" +
                          std::to_string(dt) + R"(}, "systems": [{"type": "mass_spring", "id": "s", )" +
                          system + "}]}")),
        state(world.initial_state()) {
    Workspace workspace;
    const ThreadArena arena(1);
    for (int k = 0; k < steps; ++k) world.step(state, workspace, arena, {});
  }
  Vec3 at(size_t i) const { return load3(state.systems[0].f64(0).data(), i); }
  double observed(const char* name) const {
    return world.observe(state).find(std::string("s.") + name).value();
  }
  World world;
  WorldState state;
};

// Points 0 and 1 are held; the curvature at point 1 represents half a link on either side of it, so the clamp
// is half a link before it. w L^4 / (8 EI) for a load w per length.
TEST(Bending, ARopeUnderItsWeightBendsLikeACantilever) {
  constexpr double kStiffness = 0.5, kDensity = 0.02, kGravity = 9.81;
  constexpr int kLinks = 40;
  const Rest rest(
      R"("rope": {"from": [0, 0, 0], "to": [1, 0, 0], "links": 40}, "density": 0.02, "stiffness": 1e6,
    "bending_rigidity": 0.5, "pins": [0, 1], "damping": 0.01)",
      kGravity, 400, 0.05);
  const double length = 1 - 0.5 / kLinks;
  const double expected = kDensity * kGravity * std::pow(length, 4) / (8 * kStiffness);
  EXPECT_NEAR(-rest.at(kLinks).y, expected, 0.01 * expected);
  // Forces: the pins carry the whole weight. Their moment is in the difference of the two.
  EXPECT_NEAR(rest.observed("reaction.y"), kDensity * kGravity, 1e-6);
  EXPECT_NEAR(rest.observed("reaction.x"), 0, 1e-3);
  // The control: skip springs of any stiffness hardly resist slight bends of a straight rope.
  const Rest loose(
      R"("rope": {"from": [0, 0, 0], "to": [1, 0, 0], "links": 40}, "density": 0.02, "stiffness": 1e6,
    "bending_stiffness": 1e3, "pins": [0, 1], "damping": 0.01)",
      kGravity, 400, 0.05);
  EXPECT_GT(-loose.at(kLinks).y, 5 * expected);
}

// A strip that is wide relative to its length bends like a plate, with D per width; its free sides let it
// curl, as a beam of E I = D (1 - nu^2) per width does completely. The truth lies in between (nu = 1/3: 1 and
// 1.125 times the deflection).
TEST(Bending, AClothUnderItsWeightBendsLikeAPlate) {
  constexpr double kRigidity = 5, kDensity = 0.1, kGravity = 9.81;
  constexpr int n = 13;
  std::string pins;
  for (int j = 0; j < n; ++j) {
    pins += (j ? ", " : "") + std::to_string(j * n) + ", " + std::to_string(j * n + 1);
  }
  const Rest rest(
      R"("cloth_grid": {"origin": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": 13, "ny": 13},
    "density": 0.1, "stiffness": 1e5, "shear_stiffness": 1e5, "flexural_rigidity": 5, "damping": 0.01, "pins": [)" +
          pins + "]",
      kGravity, 150, 0.05);
  const double length = 1 - 0.5 / (n - 1),
               plate = kDensity * kGravity * std::pow(length, 4) / (8 * kRigidity);
  const double middle = -rest.at(size_t{n / 2} * n + n - 1).y;
  EXPECT_GT(middle, 0.97 * plate);
  EXPECT_LT(middle, 1.15 * plate);
}

// D/2 kappa^2 per area, in whichever direction the cloth is rolled up.
TEST(Bending, APlateIsAsStiffInEveryDirection) {
  constexpr int n = 41;
  constexpr double kRigidity = 2, kRadius = 5;
  for (const double v : {1.0, 1.5}) {
    MassSpringDef def;
    def.cloth_grid = ClothGridShape{.edge_u = {1, 0, 0}, .edge_v = {0, 0, v}, .nx = n, .ny = n};
    def.stiffness = def.shear_stiffness = 0;
    def.flexural_rigidity = kRigidity;
    BuildContext context;
    context.gravity = {};
    const MassSpringField field(def, context);
    State s = field.initial_state();
    for (const double angle : {0.0, 0.4, 0.785398, 1.2, 1.570796}) {
      const Vec3 along{std::cos(angle), 0, std::sin(angle)}, across{-std::sin(angle), 0, std::cos(angle)};
      for (size_t i = 0; i < n * n; ++i) {
        const Vec3 p = field.network().x[i];
        const double a = dot(p, along) / kRadius;
        store3(s.f64(0).data(), i,
               along * (kRadius * std::sin(a)) + across * dot(p, across) +
                   Vec3{0, kRadius * (1 - std::cos(a)), 0});
      }
      Workspace workspace;
      const ThreadArena arena(1);
      Evaluation e{workspace, arena};
      const double energy = *field.potential({0, s.f64(0), s.f64(1), s}, e);
      const double expected = 0.5 * kRigidity / (kRadius * kRadius) * v;
      // Half a cell along the free sides bends without resistance: two of 40 cells, counting both sides.
      EXPECT_NEAR(energy, expected, 0.1 * expected) << angle << ' ' << v;
      EXPECT_LT(energy, expected);
    }
  }
}

TEST(Bending, TheStableStepIsOfTheRightSize) {
  const std::string rope =
      R"("rope": {"from": [0, 0, 0], "to": [1, 0, 0], "links": 20}, "mass": 0.01, "stiffness": 100,
    "bending_rigidity": 0.05, "pins": [0, 1], "integrator": "leapfrog")";
  const auto scene = [&](double dt) {
    return R"({"time": {"dt": )" + short_number(dt, 17) +
           R"(}, "systems": [{"type": "mass_spring", "id": "s", )" + rope + "}]}";
  };
  const World probe(parse_scene(scene(1e-4)));
  const double stable = *probe.stable_dt(probe.initial_state());
  const auto survives = [&](double dt) {
    const World world(parse_scene(scene(dt)));
    WorldState s = world.initial_state();
    Workspace workspace;
    const ThreadArena arena(1);
    try {
      for (int k = 0; k < 3000; ++k) world.step(s, workspace, arena, {});
    } catch (const Instability&) {
      return false;
    }
    return std::abs(load3(s.systems[0].f64(0).data(), 20).y) < 1.5;
  };
  // The reported step has the right size: half of it is stable, and twice (the control) is not.
  EXPECT_TRUE(survives(0.5 * stable));
  EXPECT_FALSE(survives(2 * stable));
}

}  // namespace
}  // namespace truestep
