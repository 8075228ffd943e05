// A session of a scene with couplings, and what it observes.
#pragma once
#include <gtest/gtest.h>

#include "engine/session/session.h"

namespace truestep::testing_coupled {

inline std::shared_ptr<const ThreadArena> threads(int n) {
  return std::make_shared<const ThreadArena>(n);
}

struct SceneRun {
  explicit SceneRun(const std::string& scene, int n_threads = 1)
      : world(std::make_shared<const World>(parse_scene(scene))), session(world, threads(n_threads)) {}
  double observe(const std::string& name) const {
    const auto v = session.observe().find(name);
    EXPECT_TRUE(v.has_value()) << name;
    return v.value_or(0);
  }
  Vec3 observe3(const std::string& name) const {
    return {observe(name + ".x"), observe(name + ".y"), observe(name + ".z")};
  }
  std::shared_ptr<const World> world;
  Session session;
};

}  // namespace truestep::testing_coupled
