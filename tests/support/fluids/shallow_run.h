// Shallow water stepped without a session around it.
#pragma once
#include <cmath>
#include <memory>
#include <string>

#include "engine/systems/heightfield_wave/heightfield_wave.h"
#include "tests/support/runs/system_run.h"

namespace truestep::test {

struct ShallowRun : testing_rig::SystemRun<std::unique_ptr<const System>> {
  ShallowRun(const heightfield_wave::HeightfieldWaveDef& d, double dt, int threads = 1)
      : SystemRun(
            [&] {
              return heightfield_wave::build_heightfield_wave(
                  &d, {.id = "water", .gravity = Vec3{0, 0, -9.81}, .dt = dt});
            },
            dt, threads) {}
  void steps(uint64_t n) { step(n); }
  uint64_t& done() { return SystemRun::steps; }
  /// Depth (m) of a cell.
  double depth(size_t cell) const { return state.f64(0)[cell]; }
};

}  // namespace truestep::test
