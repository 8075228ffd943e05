// Torn cloth used to offer other systems only its points: marbles and corners of bodies fell through the
// remaining triangles. And rows that a tear had just added were read beyond the memory of the substep's
// start.
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using testing_coupled::SceneRun;

// A sheet of 0.1 m cells, held along its border, with objects falling on it. `shot`: the speed of a ball that
// tears its middle.
std::string sheet(const std::string& systems, const std::string& couplings, double shot) {
  return R"({"schema_version": "1.0", "name": "s", "time": {"dt": 0.005, "substeps": 4},
    "systems": [{"type": "xpbd", "id": "cloth", "density": 0.2, "stiffness": 2000, "shear_stiffness": 1000,
                 "internal_damping": 0.5, "pinned": ["border"], "thickness": 0.004, "tear": {"strain": 0.15},
                 "cloth_grid": {"origin": [-0.55, 1, -0.55], "edge_u": [1.1, 0, 0], "edge_v": [0, 0, 1.1],
                                "nx": 12, "ny": 12}},
                {"type": "particles", "id": "shot", "mass": 2, "radius": 0.03, "positions": [[0, 1.05, 0]],
                 "velocities": [[0, )" +
         std::to_string(-shot) + R"(, 0]]}, )" + systems + R"(],
    "couplings": [{"type": "contact", "id": "hit", "a": "shot", "b": "cloth", "restitution": 0}, )" +
         couplings + "]}";
}

// Marbles of 5 mm over the middles of cells: four near the border, one where the ball goes through.
TEST(TornClothContact, TrianglesThatAreLeftHoldMarbles) {
  SceneRun run(sheet(R"({"type": "particles", "id": "marbles", "mass": 0.001, "radius": 0.005,
      "positions": [[-0.4, 1.02, -0.4], [0.41, 1.02, -0.4], [-0.4, 1.02, 0.41], [0.41, 1.02, 0.41], [0, 1.3, 0]]})",
                     R"({"type": "contact", "id": "touch", "a": "marbles", "b": "cloth", "restitution": 0})",
                     20));
  run.session.step(100);
  EXPECT_GT(run.observe("cloth.splits"), 3);
  const auto height = [&](size_t i) { return load3(run.session.state().systems[2].f64(0).data(), i).y; };
  // Half a second: free fall is 1.2 m. The sheet swings by a few centimetres.
  for (size_t i = 0; i < 4; ++i) EXPECT_GT(height(i), 0.85) << i;
  // Control: the marble over the hole goes through it.
  EXPECT_LT(height(4), 0.8);
  EXPECT_LT(load3(run.session.state().systems[1].f64(0).data(), 0).y, 0);
}

// A box smaller than a cell lies on a triangle by its corners.
TEST(TornClothContact, TrianglesThatAreLeftHoldBodies) {
  SceneRun run(sheet(R"({"type": "rigid3d", "id": "box", "bodies": [{"type": "box", "mass": 0.01,
      "half_extents": [0.02, 0.01, 0.02], "position": [-0.4, 1.03, -0.38]}]})",
                     R"({"type": "contact", "id": "touch", "a": "cloth", "b": "box", "restitution": 0})",
                     20));
  run.session.step(100);
  EXPECT_GT(run.observe("cloth.splits"), 3);
  // Its weight for half a second minus the time of its fall of 18 mm, 0.06 s; it still moves a little.
  EXPECT_NEAR(std::abs(run.observe("touch.impulse.y")), 0.01 * 9.81 * 0.5, 0.3 * 0.01 * 9.81 * 0.5);
}

TEST(TornClothContact, HasTheSameBitsOnTwoThreadsAndFromASnapshot) {
  const std::string scene = sheet(R"({"type": "rigid3d", "id": "box", "bodies": [{"type": "box", "mass": 0.01,
      "half_extents": [0.02, 0.01, 0.02], "position": [-0.4, 1.03, -0.38]}]})",
                                  R"({"type": "contact", "id": "touch", "a": "cloth", "b": "box"})", 20);
  SceneRun one(scene), two(scene, 2), restored(scene);
  one.session.step(20), two.session.step(20);
  EXPECT_GT(one.observe("cloth.splits"), 0);
  EXPECT_EQ(one.session.state().systems, two.session.state().systems);
  restored.session.restore(one.session.state());
  one.session.step(20), restored.session.step(20);
  EXPECT_EQ(one.session.state().systems, restored.session.state().systems);
}

}  // namespace
}  // namespace truestep
