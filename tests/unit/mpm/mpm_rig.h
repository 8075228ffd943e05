// A system of the material point method with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include <memory>

#include "engine/core/ports/medium.h"
#include "engine/systems/mpm/mpm.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing_rig {

struct MpmRun : SystemRun<mpm::Mpm> {
  explicit MpmRun(const mpm::MpmDef& def, double dt = 1.0 / 60, Vec3 gravity = {}, int threads = 1)
      : SystemRun([&] { return mpm::Mpm(def, BuildContext{.id = "s", .gravity = gravity, .dt = dt}); }, dt,
                  threads) {}

  Vec3 position(size_t i) const { return RealColumn<const double>(state, mpm::columns::position).vector(i); }
  Vec3 velocity(size_t i) const { return RealColumn<const double>(state, mpm::columns::velocity).vector(i); }
};

}  // namespace truestep::testing_rig
