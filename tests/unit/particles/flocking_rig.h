// A flock with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include "engine/systems/flocking/flocking.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing_rig {

struct FlockRun : SystemRun<flocking::Flocking> {
  explicit FlockRun(const flocking::FlockingDef& def, double dt, int threads = 1)
      : SystemRun([&] { return flocking::Flocking(def, BuildContext{.id = "s", .dt = dt, .seed = 11}); }, dt,
                  threads) {}

  Vec3 position(size_t i) const { return load3(state.f64(flocking::Columns::position).data(), i); }
  Vec3 velocity(size_t i) const { return load3(state.f64(flocking::Columns::velocity).data(), i); }
};

}  // namespace truestep::testing_rig
