#include "tests/bench/rigid3d/standing.h"

#include "tests/bench/standing.h"

namespace truestep::bench {
namespace {

std::vector<SpaceState> look(const SpaceEngine& engine, size_t bodies) {
  std::vector<SpaceState> all;
  for (size_t i = 0; i < bodies; ++i) all.push_back(engine.state(i));
  return all;
}

template <class Make>
void stand_on(const std::string& name, const SpaceScene& scene, Make make) {
  const size_t n = scene.bodies.size();
  Standing s{.scene = "3-D " + scene.name, .engine = name, .settle = scene.settle};
  if (scene.top) s.top = scene.top;
  const auto engine = make(Sleep::never);
  watch_standing(
      s, [&] { engine->step(); },
      [&] {
        std::vector<Spot> spots;
        for (const SpaceState& b : look(*engine, n)) {
          const Vec3& x = b.pose.position;
          spots.push_back({x.x, x.y, x.z});
        }
        return spots;
      },
      [&] { return energy(scene, look(*engine, n)).kinetic; });
  const auto sleeper = make(Sleep::allowed);
  watch_sleep(
      s, [&] { sleeper->step(); },
      [&] {
        for (size_t i = 0; i < n; ++i) {
          if (!scene.bodies[i].fixed && !sleeper->asleep(i)) return false;
        }
        return true;
      });
}

}  // namespace

void stand(const RapierLibrary* rapier, const std::vector<std::string>& wanted) {
  for (const SpaceScene& scene : standing_space_scenes()) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), scene.name) == wanted.end()) continue;
    stand_on("Truestep", scene, [&](Sleep sleep) { return make_ours(scene, {.sleep = sleep}); });
    if (rapier) stand_on("Rapier3d 0.36", scene, [&](Sleep sleep) { return rapier->make(scene, sleep); });
    if (make_bullet(space_stack(1, 0))) {
      stand_on("Bullet 3.24", scene, [&](Sleep sleep) { return make_bullet(scene, sleep); });
    }
  }
}

}  // namespace truestep::bench
