// Obstacles of triangles on the wire: their triangles come with the topology, their places with frames.
#include <gtest/gtest.h>

#include "engine/scene/scene.h"
#include "engine/session/world/world.h"
#include "server/stream/messages.h"

namespace truestep {
namespace {

TEST(MeshObstacles, AreSentOnceAndPlacedInEveryFrame) {
  const std::string corners =
      R"("vertices": [[0, 0, 0], [0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.3]], "triangles": [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3])";
  const World world(
      parse_scene(R"({"systems": [{"type": "sph", "bodies": [{"center": [0.5, 0.8, 0.5]}], "colliders": [
      {"type": "height_field", "count": [2, 2], "heights": [0, 0, 0.1, 0.1], "center": [0.5, 0, 0.5]},
      {"type": "sphere", "center": [0.5, 0.3, 0.5], "radius": 0.1},
      {"type": "mesh", "id": "wedge", "motion": {"velocity": [0.1, 0, 0]}, )" +
                  corners + "}]}]}"));
  WorldState state = world.initial_state();
  Frame frame;
  const auto draw = [&] {
    auto constant = std::make_shared<Drawing>();
    world.draw(state, Wish::constant | Wish::obstacles, *constant);
    frame.moving.obstacles = constant->obstacles;
    frame.constant = std::move(constant);
  };
  draw();
  const v1::ServerMessage message = topology_message(world, frame);
  const v1::Topology& t = message.topology();
  ASSERT_EQ(t.shapes_size(), 3);
  ASSERT_EQ(t.meshes_size(), 2);
  std::vector<std::string> kinds;
  for (const v1::Shape& s : t.shapes()) {
    kinds.push_back(s.kind());
    if (s.kind() != "mesh") continue;
    ASSERT_LT(s.mesh(), 2u);
    const size_t triangles = t.meshes(static_cast<int>(s.mesh())).triangles().size() / (3 * sizeof(uint32_t));
    EXPECT_EQ(triangles, s.id() == "wedge" ? 4u : 2u) << s.id();
  }
  EXPECT_EQ(kinds, (std::vector<std::string>{"sphere", "mesh", "mesh"}));
  state.step = 60;
  draw();
  v1::Frame moved;
  ASSERT_TRUE(moved.ParseFromString(shapes_fields(frame)));
  ASSERT_EQ(moved.shapes_size(), 3);
  EXPECT_EQ(moved.shapes(1).position(0), t.shapes(1).position(0)) << "the ground stays";
  EXPECT_NEAR(moved.shapes(2).position(0) - t.shapes(2).position(0), 0.1 * 60 * world.dt(), 1e-12);
  EXPECT_EQ(moved.shapes(2).mesh(), t.shapes(2).mesh());
}

}  // namespace
}  // namespace truestep
