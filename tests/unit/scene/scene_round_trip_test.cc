// The scene that a session returns is valid: it can be posted again and gives the same echo and the same
// bits.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/scene/admission.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/session.h"

namespace truestep {
namespace {

std::string faults(const std::vector<Issue>& issues) {
  std::string all;
  for (const Issue& i : issues) all += i.pointer + ": " + i.message + "\n";
  return all;
}

// Hash of the state after some steps; a scene that is meant to fail ends at its last good one.
uint64_t hash_after(Scene scene, uint64_t steps) {
  static const auto arena = std::make_shared<const ThreadArena>(1);
  Session session(std::make_shared<const World>(std::move(scene)), arena);
  try {
    session.step(steps);
  } catch (const Error&) {
  }
  return session.hash();
}

TEST(SceneRoundTrip, EchoOfEveryGallerySceneIsAScene) {
  for (const GalleryScene& g : gallery()) {
    Scene scene = parse_scene(g.text);
    const std::string echo = write_json(scene.canonical());
    SceneReport again = read_scene(parse_json(echo));
    ASSERT_TRUE(again.scene) << g.name << "\n" << faults(again.errors);
    EXPECT_EQ(write_json(again.scene->canonical()), echo) << g.name;
    // Cheap ones also run.
    if (estimate(scene).seconds_per_step > 2e-3) continue;
    scene.header.accuracy.reset(), again.scene->header.accuracy.reset();
    EXPECT_EQ(hash_after(std::move(*again.scene), 3), hash_after(std::move(scene), 3)) << g.name;
  }
}

TEST(SceneRoundTrip, OtherWordsOfAJointAreEchoedAsOurs) {
  for (const auto& [other, ours] : {std::pair("hinge", "revolute"),
                                    {"pin", "revolute"},
                                    {"slider", "prismatic"},
                                    {"ball", "spherical"},
                                    {"weld", "fixed"},
                                    {"revolute", "revolute"}}) {
    const std::string scene = R"({"systems": [{"type": "articulation", "id": "arm", "links": [{"joint": ")" +
                              std::string(other) + R"(", "mass": 1, "center": [0, -1, 0]}]}]})";
    const std::string echo = write_json(parse_scene(scene).canonical());
    EXPECT_NE(echo.find(R"("joint":")" + std::string(ours) + '"'), std::string::npos) << other << echo;
  }
}

}  // namespace
}  // namespace truestep
