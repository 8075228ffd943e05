// A flow on a grid stepped without a session around it.
#pragma once
#include <cmath>
#include <memory>
#include <string>

#include "engine/kernels/mac/trace.h"
#include "engine/systems/grid_fluid/grid_fluid.h"

namespace truestep::test {

class GridFlow {
 public:
  GridFlow(const grid_fluid::GridFluidDef& d, double dt, int threads = 1, const Vec3& gravity = {0, 0, 0})
      : dt_(dt), system(grid_fluid::build_grid_fluid(&d, {.id = "flow", .gravity = gravity, .dt = dt})), arena(threads) {
    state = system->initial_state();
  }
  const grid_fluid::FlowModel& model() const {
    return static_cast<const grid_fluid::GridFluid&>(*system).model();
  }
  void steps(uint64_t n) {
    for (uint64_t i = 0; i < n; ++i, ++done) {
      system->step(state,
                   {.t = double(done) * dt_, .h = dt_, .step = done, .workspace = workspace, .arena = arena});
    }
  }
  double t() const { return double(done) * dt_; }
  double observed(const std::string& name) const {
    Observables o;
    system->observe(state, t(), o);
    return o.find(name).value_or(NAN);
  }
  /// Component c at a place (m), by linear interpolation.
  double velocity(size_t c, double x, double y) const {
    const mac::MacGrid& g = model().grid;
    const double cells[] = {(x - g.origin[0]) / g.spacing[0], (y - g.origin[1]) / g.spacing[1], 0.5};
    return mac::interpolate(g, c, state.f64(static_cast<State::Column>(c)).data(), cells);
  }

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
