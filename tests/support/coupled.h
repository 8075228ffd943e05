// A session of a scene with couplings, and the totals that couplings must conserve.
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

/// Momenta of all points of a world; held points are left out. `scale`: sum of |m v|.
struct Sums {
  Vec3 linear, angular;
  double mass = 0, scale = 0;
  Vec3 center;
};
inline Sums sums(const World& world, const WorldState& state) {
  Sums out;
  for (size_t i = 0; i < world.size(); ++i) {
    const ConstPoints p(state.systems[i], *world.system(i).ports().points);
    for (size_t k = 0; k < p.count; ++k) {
      const double w = p.inverse_mass(k);
      if (w == 0) continue;
      const Vec3 x = load3(p.x, k), momentum = load3(p.v, k) / w;
      out.linear += momentum;
      out.angular += cross(x, momentum);
      out.scale += norm(momentum);
      out.mass += 1 / w;
      out.center += x / w;
    }
  }
  out.center = out.center / out.mass;
  return out;
}

}  // namespace truestep::testing_coupled
