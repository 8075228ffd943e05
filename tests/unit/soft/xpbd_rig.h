// An xpbd system with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "engine/systems/xpbd/xpbd.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing_rig {

struct XpbdRun : SystemRun<std::unique_ptr<const xpbd::Xpbd>> {
  explicit XpbdRun(const xpbd::XpbdDef& def, double dt = 1.0 / 60, Vec3 gravity = {0, -9.81, 0},
                   int threads = 1)
      : SystemRun(
            [&] {
              return std::make_unique<xpbd::Xpbd>(def, BuildContext{.id = "s", .gravity = gravity, .dt = dt});
            },
            dt, threads) {}

  Vec3 position(size_t i) const { return load3(state.f64(xpbd::XpbdColumns::position).data(), i); }
  Vec3 velocity(size_t i) const { return load3(state.f64(xpbd::XpbdColumns::velocity).data(), i); }
  bool finite() const {
    for (const double x : state.f64(xpbd::XpbdColumns::position)) {
      if (!std::isfinite(x)) return false;
    }
    return true;
  }
};

}  // namespace truestep::testing_rig
