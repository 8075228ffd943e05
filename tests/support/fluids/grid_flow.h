// A flow on a grid stepped without a session around it.
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "engine/systems/grid_fluid/grid_fluid.h"
#include "tests/support/runs/system_run.h"

namespace truestep::test {

struct GridFlow : testing_rig::SystemRun<std::unique_ptr<const System>> {
  GridFlow(const grid_fluid::GridFluidDef& d, double dt, int threads = 1, const Vec3& gravity = {0, 0, 0})
      : SystemRun(
            [&] { return grid_fluid::build_grid_fluid(&d, {.id = "flow", .gravity = gravity, .dt = dt}); },
            dt, threads) {}
  const grid_fluid::FlowModel& model() const {
    return static_cast<const grid_fluid::GridFluid&>(*system).model();
  }
  void steps(uint64_t n) { step(n); }
  uint64_t& done() { return SystemRun::steps; }
  /// Component c at a point (m) in the plane, by cubics through the four nearest inner values along each
  /// axis, so that sampling adds nothing to an error of second order.
  double velocity(size_t c, double x, double y) const {
    const mac::MacGrid& g = model().grid;
    const auto u = state.f64(static_cast<State::Column>(c));
    const double at[] = {x, y};
    size_t first[2] = {};
    double weight[2][4] = {};
    for (size_t a = 0; a < 2; ++a) {
      const size_t n = g.count(c, a);
      const double s = (at[a] - g.origin[a]) / g.spacing[a] - (c == a ? 0 : 0.5);
      first[a] = static_cast<size_t>(std::clamp(std::floor(s) - 1, 0.0, static_cast<double>(n - 4)));
      for (size_t i = 0; i < 4; ++i) {
        weight[a][i] = 1;
        for (size_t j = 0; j < 4; ++j) {
          if (i != j) weight[a][i] *= (s - double(first[a] + j)) / (double(i) - double(j));
        }
      }
    }
    double sum = 0;
    for (size_t j = 0; j < 4; ++j) {
      for (size_t i = 0; i < 4; ++i)
        sum += weight[0][i] * weight[1][j] * u[g.at(first[0] + i, first[1] + j, 0)];
    }
    return sum;
  }
};

}  // namespace truestep::test
