// What a session costs around its integrator: accumulator, command queue, history, finiteness check and one
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

// Attached, never due: a stream whose client pauses.
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
  WorldState bare = world->initial_state();
  Workspace workspace;
  constexpr int kSteps = 50;
  uint64_t step = 0;
  const double h = world->dt();
  const auto times = bench::interleaved(
      41,
      [&] {
        for (int i = 0; i < kSteps; ++i) session.advance(h);
      },
      [&] {
        for (int i = 0; i < kSteps; ++i, ++step) {
          world->system(0).step(bare.systems[0], {static_cast<double>(step) * h, h, step, workspace, *arena});
        }
      });
  bench::report({.bench = "session_overhead",
                 .metric = "seconds per step, cloth of some 10,000 springs, session with one idle sink",
                 .ours = times.ours / kSteps,
                 .peer = times.peer / kSteps,
                 .peer_name = "the same integrator without a session"});
  std::fprintf(stderr, "frames built: %llu\n", static_cast<unsigned long long>(session.frames_built()));
}
