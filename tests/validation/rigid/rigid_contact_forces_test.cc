// The fields contact_force and contact_load mean the same in the plane and in space: two boxes, one on the
// other, at rest under a slanting gravity that friction resists.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/session/world/world.h"

namespace truestep {
namespace {

constexpr double kMass = 2, kAcross = 2, kDown = 9;

struct Stack {
  explicit Stack(const std::string& system)
      : world(parse_scene(R"({"gravity": [2, -9, 0], "time": {"dt": 0.01}, "systems": [)" + system + "]}")),
        state(world.initial_state()) {
    for (int k = 0; k < 300; ++k) world.step(state, workspace, arena, {});
  }
  FieldView view(const std::string& name) {
    return world.field(state, world.parts().find("r", name).value(), scratch);
  }
  Vec3 force(size_t body) { return load3(static_cast<const double*>(view("contact_force").data), body); }
  double load(size_t body) { return static_cast<const double*>(view("contact_load").data)[body]; }

  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena{1};
  std::vector<double> scratch;
};

const std::string kPlane =
    R"({"type": "rigid2d", "id": "r", "precision": "f64", "sleeping": false, "bodies": [
    {"motion": "fixed", "position": [0, -0.5, 0], "shapes": [{"type": "box", "half_extents": [5, 0.5, 0]}]},
    {"position": [0, 0.5, 0], "mass": 2, "shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0]}]},
    {"position": [0, 1.5, 0], "mass": 2, "shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0]}]}]})";
const std::string kSpace =
    R"({"type": "rigid3d", "id": "r", "precision": "f64", "sleeping": false, "bodies": [
    {"type": "box", "motion": "fixed", "position": [0, -0.5, 0], "half_extents": [5, 0.5, 5]},
    {"type": "box", "position": [0, 0.5, 0], "mass": 2, "half_extents": [0.5, 0.5, 0.5]},
    {"type": "box", "position": [0, 1.5, 0], "mass": 2, "half_extents": [0.5, 0.5, 0.5]}]})";

TEST(RigidContactForces, MeanTheSameInThePlaneAndInSpace) {
  for (const std::string& system : {kPlane, kSpace}) {
    Stack s(system);
    // A body at rest is pushed by its contacts with the opposite of its weight, also between two others; the
    // floor carries both. After three seconds what is left of the impact is below a thousandth of a weight.
    const Vec3 weight = Vec3{kAcross, -kDown, 0} * kMass;
    const double rest = 1e-3 * kMass * kDown;
    const double share[] = {2, -1, -1};
    for (size_t body = 0; body < 3; ++body) {
      EXPECT_LT(norm(s.force(body) - weight * share[body]), rest) << system << body;
    }
    // The load counts normal forces on either side: the lower box has three weights on its faces, not one.
    EXPECT_NEAR(s.load(0), 2 * kMass * kDown, rest) << system;
    EXPECT_NEAR(s.load(1), 3 * kMass * kDown, rest) << system;
    EXPECT_NEAR(s.load(2), kMass * kDown, rest) << system;
  }
}

}  // namespace
}  // namespace truestep
