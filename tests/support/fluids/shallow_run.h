// Shallow water stepped without a session around it.
#pragma once
#include <cmath>
#include <memory>
#include <string>

#include "engine/systems/heightfield_wave/heightfield_wave.h"

namespace truestep::test {

class ShallowRun {
 public:
  ShallowRun(const heightfield_wave::HeightfieldWaveDef& d, double dt, int threads = 1)
      : dt_(dt),
        system(heightfield_wave::build_heightfield_wave(
            &d, {.id = "water", .gravity = Vec3{0, 0, -9.81}, .dt = dt})),
        arena(threads) {
    state = system->initial_state();
  }
  void steps(uint64_t n) {
    for (uint64_t i = 0; i < n; ++i, ++done) {
      system->step(state, {.t = t(), .h = dt_, .step = done, .workspace = workspace, .arena = arena});
    }
  }
  double t() const { return double(done) * dt_; }
  double observed(const std::string& name) const {
    Observables o;
    system->observe(state, t(), o);
    return o.find(name).value_or(NAN);
  }
  /// Depth (m) of a cell.
  double depth(size_t cell) const { return state.f64(0)[cell]; }

 private:
  double dt_;

 public:
  std::unique_ptr<const System> system;
  State state;
  Workspace workspace;
  ThreadArena arena;
  uint64_t done = 0;
};

}  // namespace truestep::test
