// A scene in which two meshes would meet is refused, because they fall through each other; spawning the
// second one used to be let through.
#include "engine/base/errors.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using testing_coupled::SceneRun;

TEST(SpawnedMesh, ThatWouldFallThroughAnotherIsRefused) {
  const auto scene = [](const std::string& mask) {
    return R"({"schema_version": "1.0", "name": "s", "systems": [{"type": "rigid3d", "id": "bodies", "bodies": [
      {"type": "mesh", "id": "pyramid", "density": 500, "position": [0, 1, 0])" +
           mask + R"(, "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
       "triangles": [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]},
      {"type": "box", "id": "box", "half_extents": [0.1, 0.1, 0.1]}]}]})";
  };
  const auto spawned = [](SceneRun& run, const std::string& name) -> std::string {
    State copy = run.session.state().systems[0];
    try {
      run.world->system(0).apply(copy, {.kind = CommandKind::spawn, .vector = {0, 3, 0}, .name = name});
    } catch (const Error& e) {
      return e.issues().at(0).code;
    }
    return "";
  };
  SceneRun meet(scene(""));
  EXPECT_EQ(spawned(meet, "pyramid"), "surfaces_do_not_meet");
  // Controls: another shape, and meshes that let each other pass.
  EXPECT_EQ(spawned(meet, "box"), "");
  SceneRun pass(scene(R"(, "category": 2, "mask": 1)"));
  EXPECT_EQ(spawned(pass, "pyramid"), "");
}

}  // namespace
}  // namespace truestep
