// Steps that are too long for couplings, or for points held against bodies, are divided: once for both, and
// by the gravity that bodies and medium really have.
#include <array>
#include <cmath>

#include "engine/scene/catalogue.h"
#include "tests/support/immersed_scenes.h"

namespace truestep {
namespace {

using namespace testing_coupled;

/// How often each system of a scene is built.
struct Builds {
  static inline std::array<const CatalogueRow*, 3> real{};
  static inline std::array<int, 3> count{};
  template <size_t k>
  static std::unique_ptr<const System> build(const void* def, const BuildContext& context) {
    ++count[k];
    return real[k]->build(def, context);
  }
  /// Counts the builds of the scene's world; returns its substeps.
  static int64_t of(const std::string& text) {
    Scene scene = parse_scene(text);
    constexpr std::array kBuilds{&build<0>, &build<1>, &build<2>};
    std::array<CatalogueRow, 3> rows{};
    count = {};
    for (size_t i = 0; i < scene.systems.size(); ++i) {
      real[i] = scene.systems[i].row;
      rows[i] = *real[i], rows[i].build = kBuilds[i];
      scene.systems[i].row = &rows[i];
    }
    return World(std::move(scene)).scene().substeps();
  }
};

/// Cloth over a crate that may float in water.
std::string cloth_over_water(double dt, double stiffness, bool contact) {
  return R"({"time": {"dt": )" + number(dt) + R"(}, "systems": [
      {"type": "mass_spring", "id": "cloth", "cloth_grid": {"origin": [-1, 1, -1], "edge_u": [2, 0, 0],
        "edge_v": [0, 0, 2], "nx": 8, "ny": 8}, "mass": 0.004, "stiffness": )" +
         number(stiffness) + R"(, "shear_stiffness": )" + number(stiffness / 4) +
         R"(, "pinned": ["border"], "thickness": 0.02},
      {"type": "rigid3d", "id": "bodies", "bodies": [{"type": "box", "half_extents": [0.1, 0.1, 0.1],
        "position": [0.3, 0.6, 0.3], "mass": 1}]},
      {"type": "sph", "id": "water", "low": [0, 0, 0], "high": [0.6, 0.6, 0.6], "spacing": 0.05,
        "bodies": [{"center": [0.3, 0.1, 0.3], "half_extents": [0.3, 0.1, 0.3]}]}],
    "couplings": [)" +
         (contact ? R"({"type": "contact", "id": "catch", "a": "cloth", "b": "bodies"}, )" : "") +
         R"({"type": "immersion", "id": "afloat", "a": "bodies", "b": "water"}]})";
}

TEST(CoupledSubsteps, SystemsAreBuiltOnceMoreForAllThatNeedsThem) {
  // The springs alone, water alone (falls of a tenth of the spacing: 0.0319 s), and both in either order.
  constexpr double kLong = 0.1, kShort = 0.02;
  const int64_t water = Builds::of(cloth_over_water(kLong, 2000, false));
  EXPECT_EQ(water, 4);
  EXPECT_EQ(Builds::count, (std::array{2, 2, 2}));
  const int64_t springs = Builds::of(cloth_over_water(kShort, 2000, true));
  EXPECT_GT(springs, 4);
  // Once more because its points meet bodies.
  EXPECT_EQ(Builds::count, (std::array{3, 2, 2}));
  const int64_t most = Builds::of(cloth_over_water(kLong, 2000, true));
  EXPECT_GE(most, 5 * (springs - 1));
  EXPECT_EQ(Builds::count, (std::array{3, 2, 2}));
  EXPECT_EQ(Builds::of(cloth_over_water(kLong, 0.05, true)), 4) << "soft springs follow the water";
  EXPECT_EQ(Builds::count, (std::array{3, 2, 2}));
  // Control: what needs no substeps is not built again.
  EXPECT_EQ(Builds::of(cloth_over_water(kShort, 2000, false)), 1);
  EXPECT_EQ(Builds::count, (std::array{1, 1, 1}));
}

/// Substeps in which a body falls by at most a tenth of the spacing.
int64_t needed(double gravity) {
  return static_cast<int64_t>(std::ceil(0.1 / std::sqrt(2 * 0.1 * 0.05 / gravity)));
}
int64_t substeps_of(const std::string& gravity_of_bodies, const Vec3& gravity) {
  const std::string member = gravity_of_bodies.empty() ? "" : R"("gravity": )" + gravity_of_bodies + ", ";
  std::string scene =
      Bath{.depth = 0.2,
           .spacing = 0.05,
           .dt = 0.1,
           .body = R"("type": "sphere", "radius": 0.1, "position": [0.3, 0.45, 0.3], "mass": 1)",
           .gravity = gravity}
          .scene();
  scene.insert(scene.find(R"("id": "crates")"), member);
  return SceneRun(scene).world->scene().substeps();
}

TEST(CoupledSubsteps, BodiesFallByTheirOwnGravity) {
  EXPECT_EQ(substeps_of("", {0, -9.81, 0}), needed(9.81));
  EXPECT_EQ(substeps_of("[0, -98.1, 0]", {0, -9.81, 0}), needed(98.1));
  EXPECT_GT(needed(98.1), needed(9.81));
  // The water falls by the scene's gravity, whatever the bodies' is.
  EXPECT_EQ(substeps_of("[0, 0, 0]", {0, -9.81, 0}), needed(9.81));
  EXPECT_EQ(substeps_of("[0, -9.81, 0]", {0, 0, 0}), needed(9.81));
  EXPECT_EQ(substeps_of("", {0, 0, 0}), 1) << "control";
}

TEST(CoupledSubsteps, GravityThatChangesChangesTheLongestStep) {
  SceneRun run(Bath{.depth = 0.2,
                    .spacing = 0.05,
                    .body = R"("type": "sphere", "radius": 0.1, "position": [0.3, 0.45, 0.3], "mass": 1)"}
                   .scene());
  const double before = run.world->stable_dt(run.session.state()).value();
  Command c;
  c.kind = CommandKind::set_parameter, c.system = "crates", c.name = "gravity", c.vector = {0, -981, 0};
  run.session.post(c);
  run.session.step(1);
  EXPECT_NEAR(run.world->stable_dt(run.session.state()).value(), std::sqrt(2 * 0.1 * 0.05 / 981), 1e-6);
  EXPECT_GT(before, 2 * std::sqrt(2 * 0.1 * 0.05 / 981));  // control
}

}  // namespace
}  // namespace truestep
