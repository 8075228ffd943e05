// One seed of a scene gives every system numbers of its own.
#include <gtest/gtest.h>

#include <set>

#include "engine/scene/scene.h"

namespace truestep {
namespace {

Scene two_systems(uint64_t seed) {
  return parse_scene(R"({"seed": )" + std::to_string(seed) + R"(, "systems": [
    {"type": "oscillator", "stiffness": 1}, {"type": "oscillator", "stiffness": 1}]})");
}

TEST(Seeds, SystemsAndSeedsDoNotShareNumbers) {
  std::set<uint64_t> seen;
  for (const uint64_t seed : {uint64_t{1}, uint64_t{2}, uint64_t{1} << 33}) {
    const Scene scene = two_systems(seed);
    for (size_t system = 0; system < 2; ++system) {
      EXPECT_TRUE(seen.insert(scene.context(system).seed).second) << seed << ", system " << system;
      EXPECT_EQ(two_systems(seed).context(system).seed, scene.context(system).seed) << "repeats";
    }
  }
}

}  // namespace
}  // namespace truestep
