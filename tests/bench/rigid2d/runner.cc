// rigid2d_runner [standing] [NAME=LIBRARY | SCENE]...: rigid bodies in the plane beside Rapier2d and Box2D v3
// (libraries of peers/rapier2d and peers/box2d3) and, if installed, Box2D 2.4. Engines alternate in turns of
// ten steps on the same scene; milliseconds of one thread per step beside the worst overlap or joint gap at
// twenty moments of the last three quarters.
#include <algorithm>
#include <cstring>

#include "tests/bench/report.h"
#include "tests/bench/rigid2d/engines.h"
#include "tests/bench/rigid2d/standing.h"

namespace truestep::bench {
namespace {

constexpr int kTurn = 10;

struct Player {
  std::string name;
  std::unique_ptr<FlatEngine> engine;
  double seconds = 0, error = 0;
};

void play(const FlatScene& scene, std::vector<Player>& players) {
  std::vector<FlatPose> poses(scene.bodies.size());
  const int every = scene.steps / 20;
  for (int done = 0; done < scene.steps; done += kTurn) {
    for (Player& p : players) {
      const double start = thread_seconds();
      for (int k = 0; k < kTurn; ++k) p.engine->step();
      p.seconds += thread_seconds() - start;
      if (4 * done < scene.steps || done % every >= kTurn) continue;
      for (size_t i = 0; i < poses.size(); ++i) poses[i] = p.engine->look(i).pose;
      p.error = std::max(p.error, flat_error(scene, poses));
    }
  }
  for (size_t i = 1; i < players.size(); ++i) {
    report({.bench = "rigid2d",
            .metric = scene.name + ", ms per step",
            .ours = 1e3 * players[0].seconds / scene.steps,
            .peer = 1e3 * players[i].seconds / scene.steps,
            .peer_name = players[i].name,
            .error_ours = players[0].error,
            .error_peer = players[i].error});
  }
}

}  // namespace
}  // namespace truestep::bench

int main(int count, char** arguments) {
  using namespace truestep::bench;
  const bool standing = count > 1 && !std::strcmp(arguments[1], "standing");
  // Libraries have a "=", the others are names of scenes.
  std::vector<std::string> wanted;
  std::vector<char*> named;
  for (int i = 1 + standing; i < count; ++i) {
    if (std::strchr(arguments[i], '=')) {
      named.push_back(arguments[i]);
    } else {
      wanted.push_back(arguments[i]);
    }
  }
  const auto libraries = open_flat_libraries(named);
  if (standing) return stand(libraries, wanted), 0;
  for (const FlatScene& scene : flat_scenes()) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), scene.name) == wanted.end()) continue;
    std::vector<Player> players;
    players.push_back({"Truestep", make_ours(scene)});
    for (const FlatLibrary& l : libraries) players.push_back({l.name, l.make(scene)});
    if (auto box2d = make_box2d(scene)) players.push_back({"Box2D 2.4", std::move(box2d)});
    play(scene, players);
  }
}
