// A plate's stiffness in every direction, and the size of the stable step of what bends. (Cantilevers are in
// tests/scenes/soft/cantilevers_bend_as_beams.json.)
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/text/short_number.h"
#include "engine/scene/json/json.h"
#include "engine/session/world/world.h"
#include "engine/systems/mass_spring/mass_spring_field.h"

namespace truestep {
using namespace mass_spring;
namespace {

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
