// The cost of a session around its integrator: accumulator, command queue, history, finiteness check and one
// idle sink, on a cloth of some 10,000 springs, beside the bare loop of the same integrator over the same
// state.
#include <cstdio>

#include "engine/session/session.h"
#include "tests/bench/report.h"

namespace truestep {
namespace {

const char* const kScene = R"({"time": {"dt": 0.0001}, "systems": [{"type": "mass_spring", "id": "c",
  "cloth_grid": {"origin": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": 42, "ny": 42},
  "density": 0.3, "stiffness": 400, "shear_stiffness": 100, "bending_stiffness": 5, "pinned": ["corner_00", "corner_10"],
  "integrator": "symplectic_euler"}]})";

// Attached but never due, like a stream whose client pauses.
class IdleSink : public Sink {
 public:
  bool due(uint64_t) override { return false; }
  const FrameRequest& request() const override { return request_; }
  void accept(const FramePtr&) override {}

 private:
  FrameRequest request_;
};

}  // namespace
}  // namespace truestep

int main() {
  using namespace truestep;
  const auto world = std::make_shared<const World>(parse_scene(kScene));
  const auto arena = std::make_shared<const ThreadArena>(1);
  Session session(world, arena);
  session.add_sink(std::make_shared<IdleSink>());
  session.play(1);
  WorldState bare = world->initial_state(), other = bare;
  Workspace workspace, other_workspace;
  // The interval of the first snapshots: every round includes one.
  constexpr int kSteps = 128, kRounds = 301;
  const double h = world->dt();
  const auto loop = [&](WorldState& state, Workspace& scratch) {
    for (int i = 0; i < kSteps; ++i, ++state.step) {
      world->system(0).step(state.systems[0],
                            {static_cast<double>(state.step) * h, h, state.step, scratch, *arena});
    }
  };
  const auto noise = bench::paired(
      kRounds, [&] { loop(other, other_workspace); }, [&] { loop(bare, workspace); }, bench::thread_seconds);
  const auto cost = bench::paired(
      kRounds,
      [&] {
        for (int i = 0; i < kSteps; ++i) session.advance(h);
      },
      [&] { loop(bare, workspace); }, bench::thread_seconds);
  bench::report({.bench = "session_overhead",
                 .metric = "CPU seconds per step, cloth of some 10,000 springs, session with one idle sink",
                 .ours = cost.times.ours / kSteps,
                 .peer = cost.times.peer / kSteps,
                 .peer_name = "the same integrator without a session"});
  const auto line = [](const char* what, const bench::Paired& p) {
    std::fprintf(stderr, "%s: %+.2f %% (quartiles %+.2f, %+.2f)\n", what, 100 * (p.middle - 1),
                 100 * (p.low - 1), 100 * (p.high - 1));
  };
  line("the loop beside itself", noise);
  line("session beside the loop", cost);
  std::fprintf(stderr, "frames built: %llu, memory beside the state: %zu bytes\n",
               static_cast<unsigned long long>(session.frames_built()), session.overhead_bytes());
}
