#include "tests/bench/rigid2d/standing.h"

#include "tests/bench/standing.h"

namespace truestep::bench {
namespace {

std::vector<FlatState> look(const FlatEngine& engine, size_t bodies) {
  std::vector<FlatState> all;
  for (size_t i = 0; i < bodies; ++i) all.push_back(engine.look(i));
  return all;
}

template <class Make>
void stand_on(const std::string& name, const FlatScene& scene, Make make) {
  const size_t n = scene.bodies.size();
  Standing s{.scene = "2-D " + scene.name, .engine = name, .settle = scene.settle};
  if (scene.top) s.top = scene.top;
  const auto engine = make(Sleep::never);
  watch_standing(
      s, [&] { engine->step(); },
      [&] {
        std::vector<Spot> spots;
        for (const FlatState& b : look(*engine, n)) spots.push_back({b.pose.x, 0, b.pose.y});
        return spots;
      },
      [&] { return flat_kinetic(scene, look(*engine, n)); });
  const auto sleeper = make(Sleep::allowed);
  watch_sleep(
      s, [&] { sleeper->step(); },
      [&] {
        for (size_t i = 0; i < n; ++i) {
          if (scene.bodies[i].kind != FlatBody::Kind::fixed && !sleeper->asleep(i)) return false;
        }
        return true;
      });
}

}  // namespace

void stand(const std::vector<FlatLibrary>& libraries, const std::vector<std::string>& wanted) {
  for (const FlatScene& scene : standing_flat_scenes()) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), scene.name) == wanted.end()) continue;
    stand_on("Truestep", scene, [&](Sleep sleep) { return make_ours(scene, sleep); });
    for (const FlatLibrary& l : libraries)
      stand_on(l.name, scene, [&](Sleep sleep) { return l.make(scene, sleep); });
  }
}

}  // namespace truestep::bench
