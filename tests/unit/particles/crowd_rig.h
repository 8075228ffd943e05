// A crowd with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include "engine/systems/crowd/crowd.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing_rig {

struct CrowdRun : SystemRun<crowd::Crowd> {
  explicit CrowdRun(const crowd::CrowdDef& def, double dt = 1.0 / 60, int threads = 1, uint64_t seed = 11)
      : SystemRun([&] { return crowd::Crowd(def, BuildContext{.id = "s", .dt = dt, .seed = seed}); }, dt,
                  threads) {}

  size_t people() const { return state.rows(crowd::Columns::position); }
  Vec3 position(size_t i) const { return load3(state.f64(crowd::Columns::position).data(), i); }
  Vec3 velocity(size_t i) const { return load3(state.f64(crowd::Columns::velocity).data(), i); }
};

/// A person at `from` who makes for `to`.
inline crowd::GroupDef walker(const Vec3& from, const Vec3& to) {
  crowd::GroupDef g;
  g.positions = {from}, g.goals = {to};
  return g;
}

}  // namespace truestep::testing_rig
