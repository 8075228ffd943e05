// What a session adds to a step: nothing but the system's own loop, a session without sinks, one whose sink
// is never due, and one that builds a frame after every step.
//   step_cost_runner                     a JSON line per scene and way, CPU seconds of a step beside the bare
//   loop step_cost_runner WAY SCENE STEPS     that many steps in the function counted_steps, after a hundred
//   others,
//                                        for callgrind (step_cost.py)
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string_view>

#include "engine/session/session.h"
#include "engine/sinks/stream/frame_encoding.h"
#include "tests/bench/report.h"

namespace truestep::bench {
namespace {

struct Scene {
  const char *name, *what, *json;
  int steps;  ///< of a round
};
constexpr Scene kScenes[] = {
    {"two_points", "two points on a spring", R"({"time": {"dt": 0.001}, "systems": [{"type": "mass_spring",
      "id": "c", "rope": {"from": [0, 0, 0], "to": [1, 0, 0], "links": 1}, "pins": [0],
      "integrator": "symplectic_euler"}]})",
     8192},
    {"cloth", "cloth of some 10,000 springs", R"({"time": {"dt": 0.0001}, "systems": [{"type": "mass_spring",
      "id": "c", "cloth_grid": {"origin": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": 42, "ny": 42},
      "density": 0.3, "stiffness": 400, "shear_stiffness": 100, "bending_stiffness": 5,
      "pinned": ["corner_00", "corner_10"], "integrator": "symplectic_euler"}]})",
     128},
    {"boxes", "fifty resting boxes", R"({"time": {"dt": 0.0166}, "systems": [{"type": "rigid3d", "id": "c",
      "sleeping": false, "bodies": [{"type": "plane", "normal": [0, 1, 0], "motion": "fixed"}, {"type": "box",
      "half_extents": [0.2, 0.2, 0.2], "position": [0, 0.2, 0], "mass": 1,
      "copies": {"layout": "grid", "count": [10, 1, 5], "spacing": [1, 1, 1]}}]}]})",
     64}};

/// Asks for what a viewer would get, of every n-th step; 0: of none.
class CountingSink final : public Sink {
 public:
  CountingSink(const World& world, uint64_t every)
      : every_(every),
        request_(request_for(wire_fields(world, {}, {}, WireEncoding::f32), FrameRequest::Extras::none)) {}
  bool due(uint64_t step) override { return every_ > 0 && step % every_ == 0; }
  const FrameRequest& request() const override { return request_; }
  void accept(const FramePtr&) override { ++frames; }

  uint64_t frames = 0;

 private:
  uint64_t every_;
  FrameRequest request_;
};

enum class Way : uint8_t { bare, session, idle_sink, frames };
constexpr const char* kWays[] = {"bare", "session", "idle_sink", "frames"};

class Run {
 public:
  Run(const Scene& scene, Way way)
      : way_(way), world_(std::make_shared<const World>(parse_scene(scene.json))), session_(world_, arena_) {
    if (way == Way::idle_sink || way == Way::frames)
      session_.add_sink(std::make_shared<CountingSink>(*world_, way == Way::frames ? 1 : 0));
    session_.play(1);
  }
  void steps(int n) {
    const double h = world_->dt();
    for (int i = 0; i < n; ++i) {
      if (way_ != Way::bare) {
        session_.advance(h);
        continue;
      }
      world_->system(0).step(state_.systems[0],
                             {static_cast<double>(state_.step) * h, h, state_.step, workspace_, *arena_});
      ++state_.step;
    }
  }
  uint64_t frames_built() const { return session_.frames_built(); }
  size_t overhead_bytes() const { return session_.overhead_bytes(); }

 private:
  Way way_;
  std::shared_ptr<const World> world_;
  std::shared_ptr<const ThreadArena> arena_ = std::make_shared<const ThreadArena>(1);
  Session session_;
  WorldState state_ = world_->initial_state();
  Workspace workspace_;
};

[[gnu::noinline]] void counted_steps(Run& run, int steps) {
  run.steps(steps);
}

void measure(const Scene& scene) {
  constexpr int kRounds = 101;
  for (const Way way : {Way::session, Way::idle_sink, Way::frames}) {
    Run ours(scene, way), bare(scene, Way::bare);
    const Paired p = paired(
        kRounds, [&] { ours.steps(scene.steps); }, [&] { bare.steps(scene.steps); }, thread_seconds);
    report({.bench = std::string("step_cost.") + kWays[static_cast<size_t>(way)],
            .metric = std::string("CPU seconds per step, ") + scene.what,
            .ours = p.times.ours / scene.steps,
            .peer = p.times.peer / scene.steps,
            .peer_name = "the system's loop alone"});
    std::fprintf(
        stderr, "%s, %s: %+.1f %% (quartiles %+.1f, %+.1f), %llu frames, %zu bytes beside the state\n",
        scene.name, kWays[static_cast<size_t>(way)], 100 * (p.middle - 1), 100 * (p.low - 1),
        100 * (p.high - 1), static_cast<unsigned long long>(ours.frames_built()), ours.overhead_bytes());
  }
}

}  // namespace
}  // namespace truestep::bench

int main(int argc, char** argv) {
  using namespace truestep::bench;
  if (argc != 4) {
    for (const Scene& s : kScenes) measure(s);
    return 0;
  }
  for (size_t way = 0; way < std::size(kWays); ++way) {
    for (const Scene& s : kScenes) {
      if (std::string_view(argv[1]) != kWays[way] || std::string_view(argv[2]) != s.name) continue;
      Run run(s, static_cast<Way>(way));
      run.steps(100);  // the first ones allocate
      counted_steps(run, std::atoi(argv[3]));
      return 0;
    }
  }
  std::fprintf(stderr, "no such way or scene\n");
  return 1;
}
