// rigid3d_runner [standing] [LIBRARY [SCENE...]]: rigid bodies in space beside Rapier3d (LIBRARY is the peer
// of peers/rapier3d) and Bullet if installed. Engines alternate in turns of ten steps on the same scene;
// milliseconds of one thread per step beside the deepest overlap or widest gap at twenty moments of the last
// three quarters, then what is conserved: the drift of the topmost body, the energy left in bodies that
// should rest. Ours beside itself: doubles, two threads, asleep, many small sessions.
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "tests/bench/report.h"
#include "tests/bench/rigid3d/engines.h"
#include "tests/bench/rigid3d/standing.h"

namespace truestep::bench {
namespace {

constexpr int kTurn = 10;

struct Player {
  std::string name;
  std::unique_ptr<SpaceEngine> engine;
  double seconds = 0, error = 0;
  std::vector<SpaceState> state = {};
};

void look(Player& p) {
  for (size_t i = 0; i < p.state.size(); ++i) p.state[i] = p.engine->state(i);
}

/// A lower bound for figures that may be 0, so that ratios exist.
double positive(double x) {
  return std::max(x, 1e-12);
}

void compare(const SpaceScene& scene, const std::vector<Player>& players, const char* what, auto&& figure) {
  for (size_t i = 1; i < players.size(); ++i) {
    report({.bench = "rigid3d",
            .metric = scene.name + ", " + what,
            .ours = positive(figure(players[0])),
            .peer = positive(figure(players[i])),
            .peer_name = players[i].name});
  }
}

void play(const SpaceScene& scene, std::vector<Player>& players) {
  const int every = std::max(scene.steps / 20, kTurn);
  for (Player& p : players) p.state.resize(scene.bodies.size()), look(p);
  const SpaceEnergy first = energy(scene, players[0].state);
  for (int done = 0; done < scene.steps; done += kTurn) {
    for (Player& p : players) {
      const double start = thread_seconds();
      for (int k = 0; k < kTurn; ++k) p.engine->step();
      p.seconds += thread_seconds() - start;
      if ((done + kTurn) % every >= kTurn && done + kTurn < scene.steps) continue;
      look(p);
      if (scene.bodies.size() == 1) {
        p.error = turn_error(scene.bodies[0], p.state[0], (done + kTurn) * kSpaceDt);
      } else if (!scene.joints.empty()) {
        p.error = std::max(p.error, widest(scene, p.state));
      } else if (4 * done >= scene.steps) {
        p.error = std::max(p.error, deepest(scene, p.state));
      }
    }
  }
  for (size_t i = 1; i < players.size(); ++i) {
    report({.bench = "rigid3d",
            .metric = scene.name + ", ms per step",
            .ours = 1e3 * players[0].seconds / scene.steps,
            .peer = 1e3 * players[i].seconds / scene.steps,
            .peer_name = players[i].name,
            .error_ours = players[0].error,
            .error_peer = players[i].error});
  }
  const auto total = [&](const Player& p) {
    const SpaceEnergy e = energy(scene, p.state);
    return e.kinetic + e.potential;
  };
  if (scene.bodies.size() == 1) {
    compare(scene, players, "relative energy change",
            [&](const Player& p) { return std::abs(total(p) / first.kinetic - 1); });
  } else if (!scene.joints.empty()) {
    double range = 0;  // energy of all bodies falling from top to bottom
    for (const SpaceBody& b : scene.bodies) {
      if (!b.fixed) range += mass(b) * norm(scene.gravity) * -scene.bodies.back().pose.position.z;
    }
    compare(scene, players, "gap at the end, m", [&](const Player& p) { return widest(scene, p.state); });
    compare(scene, players, "energy change / range",
            [&](const Player& p) { return std::abs(total(p) - first.potential) / range; });
  } else {
    if (scene.name != "pile") {
      compare(scene, players, "drift of the top body, m", [&](const Player& p) {
        const Vec3 d = p.state.back().pose.position - scene.bodies.back().pose.position;
        return std::hypot(d.x, d.y);
      });
      compare(scene, players, "sinking of the top body, m", [&](const Player& p) {
        return std::abs(scene.bodies.back().pose.position.z - p.state.back().pose.position.z);
      });
    }
    compare(scene, players, "kinetic energy at the end, J",
            [&](const Player& p) { return energy(scene, p.state).kinetic; });
  }
}

void run(SpaceEngine& engine, int steps) {
  for (int k = 0; k < steps; ++k) engine.step();
}

/// Seconds per step of two variants of ours, after both have settled.
void beside_itself(const std::string& metric, const char* peer_name, SpaceEngine& ours, SpaceEngine& peer,
                   int settle, double (*clock)(), int threads = 1) {
  constexpr int kRounds = 9, kSteps = 20;
  run(ours, settle), run(peer, settle);
  const auto t = paired(
      kRounds, [&] { run(ours, kSteps); }, [&] { run(peer, kSteps); }, clock);
  report({.bench = "rigid3d",
          .metric = metric,
          .ours = 1e3 * t.times.ours / kSteps,
          .peer = 1e3 * t.times.peer / kSteps,
          .peer_name = peer_name,
          .threads = threads});
}

void ours_beside_itself(const std::vector<SpaceScene>& scenes) {
  for (const SpaceScene& s : {scenes[0], scenes[1]}) {
    beside_itself(s.name + ", wall ms per step", "one thread", *make_ours(s, {.threads = 2}), *make_ours(s),
                  240, now_seconds, 2);
  }
  const SpaceScene& pyramid = scenes[0];
  beside_itself("pyramid, ms per step", "the same in f64", *make_ours(pyramid),
                *make_ours(pyramid, {.numbers = OursSettings::Numbers::f64}), 60, thread_seconds);
  beside_itself("pyramid asleep, ms per step", "the same awake",
                *make_ours(pyramid, {.sleep = Sleep::allowed}), *make_ours(pyramid), 900, thread_seconds);
  // A thousand boxes on the ground, alone or together.
  struct Crowd final : SpaceEngine {
    void step() override {
      for (const auto& e : all) e->step();
    }
    SpaceState state(size_t) const override { return {}; }
    bool asleep(size_t) const override { return false; }
    std::vector<std::unique_ptr<SpaceEngine>> all;
  } crowd;
  SpaceScene together = space_stack(0, 0);
  for (int k = 0; k < 1000; ++k) {
    crowd.all.push_back(make_ours(space_stack(1, 0)));
    together.bodies.push_back({.pose = {{2.0 * (k % 32) - 32, 2.0 * (k / 32) - 32, 0.5}, {}}});
  }
  beside_itself("1000 boxes in one session, ms per step", "1000 sessions of one box", *make_ours(together),
                crowd, 60, thread_seconds);
}

}  // namespace
}  // namespace truestep::bench

int main(int count, char** arguments) {
  using namespace truestep::bench;
  const bool standing = count > 1 && !std::strcmp(arguments[1], "standing");
  count -= standing, arguments += standing;
  const auto rapier = count > 1 && *arguments[1] ? RapierLibrary::open(arguments[1]) : nullptr;
  if (count > 1 && *arguments[1] && !rapier) std::fprintf(stderr, "%s: no such peer\n", arguments[1]);
  const auto wanted = [&](const std::string& name) {
    return count <= 2 || std::any_of(arguments + 2, arguments + count, [&](char* a) { return name == a; });
  };
  if (standing) return stand(rapier.get(), {arguments + std::min(count, 2), arguments + count}), 0;
  const auto scenes = space_scenes();
  for (const SpaceScene& scene : scenes) {
    if (!wanted(scene.name)) continue;
    std::vector<Player> players;
    players.push_back({"Truestep", make_ours(scene)});
    if (rapier) players.push_back({"Rapier3d 0.36", rapier->make(scene)});
    if (auto bullet = make_bullet(scene)) players.push_back({"Bullet 3.24", std::move(bullet)});
    play(scene, players);
  }
  if (wanted("ours")) ours_beside_itself(scenes);
}
