// What a contact between two systems costs per step: 100,000 particles settling on a cloth of 100 x 100
// points, beside the same two systems without the coupling.
#include <cstdio>

#include "engine/session/world/world.h"
#include "tests/bench/report.h"

namespace truestep {
namespace {

std::string scene(const char* couplings) {
  return std::string(R"({"seed": 3, "time": {"dt": 0.0005}, "systems": [
    {"type": "mass_spring", "id": "cloth", "cloth_grid": {"origin": [-2, 0, -2], "edge_u": [4, 0, 0],
     "edge_v": [0, 0, 4], "nx": 100, "ny": 100}, "mass": 0.02, "stiffness": 2000, "shear_stiffness": 500,
     "internal_damping": 0.2, "pinned": ["border"], "integrator": "symplectic_euler"},
    {"type": "particles", "id": "dust", "mass": 0.0001, "radius": 0.005, "fill": [{"count": 100000,
     "arrangement": "random", "center": [0, 0.55, 0], "half_extents": [1.9, 0.5, 1.9], "velocity": [0, -2, 0]}]}],
    "couplings": [)") +
         couplings + "]}";
}

struct Stepped {
  explicit Stepped(const char* couplings)
      : world(parse_scene(scene(couplings))), state(world.initial_state()) {}
  void steps(int n) {
    for (int i = 0; i < n; ++i) world.step(state, workspace, arena, {});
  }
  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena{1};
};

}  // namespace
}  // namespace truestep

int main() {
  using namespace truestep;
  Stepped coupled(R"({"type": "contact", "id": "c", "a": "dust", "b": "cloth"})"), apart("");
  const auto contacts = [&] { return coupled.world.observe(coupled.state).find("c.contacts").value_or(0); };
  constexpr int kSteps = 4;
  // A quarter of a second later half of the particles have landed. Seconds of one thread.
  for (const int warm_up : {0, 500}) {
    coupled.steps(warm_up);
    apart.steps(warm_up);
    const auto times =
        bench::paired(
            11, [&] { coupled.steps(kSteps); }, [&] { apart.steps(kSteps); }, bench::thread_seconds)
            .times;
    bench::report({.bench = "contact",
                   .metric = warm_up == 0 ? "seconds per step, 100,000 particles above a cloth of 100 x 100"
                                          : "seconds per step, half of them on it",
                   .ours = times.ours / kSteps,
                   .peer = times.peer / kSteps,
                   .peer_name = "the two systems without a coupling"});
    std::fprintf(stderr, "contacts in the last step: %.0f\n", contacts());
  }
}
