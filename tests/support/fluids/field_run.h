// A system on a lattice stepped without a session around it.
#pragma once
#include <cmath>
#include <memory>
#include <string>

#include "engine/systems/heat/heat.h"
#include "engine/systems/wave/wave.h"

namespace truestep::test {

class FieldRun {
 public:
  FieldRun(const heat::HeatDef& d, double dt, int threads = 1) : dt_(dt), arena(threads) {
    system = heat::build_heat(&d, {.id = "field", .dt = dt});
    lattice = static_cast<const heat::Heat&>(*system).model().lattice();
    state = system->initial_state();
  }
  FieldRun(const wave::WaveDef& d, double dt, int threads = 1) : dt_(dt), arena(threads) {
    system = wave::build_wave(&d, {.id = "field", .dt = dt});
    lattice = static_cast<const wave::Wave&>(*system).model().lattice();
    state = system->initial_state();
  }
  void steps(uint64_t n) {
    for (uint64_t i = 0; i < n; ++i, ++done) {
      system->step(state,
                   {.t = double(done) * dt_, .h = dt_, .step = done, .workspace = workspace, .arena = arena});
    }
  }
  double t() const { return double(done) * dt_; }
  std::span<const double> values() const { return state.f64(0); }
  /// Largest distance of the values from exact(x, y, z).
  template <class Exact>
  double error(Exact exact) const {
    double worst = 0;
    for (size_t i = 0; i < values().size(); ++i) {
      const auto p = lattice.place(i);
      double at[3] = {};
      for (size_t a = 0; a < lattice.dimensions; ++a) at[a] = lattice.axes[a].at(p[a]);
      worst = std::max(worst, std::abs(values()[i] - exact(at[0], at[1], at[2])));
    }
    return worst;
  }
  double observed(const std::string& name) const {
    Observables o;
    system->observe(state, t(), o);
    return o.find(name).value_or(NAN);
  }

 private:
  double dt_;

 public:
  std::unique_ptr<const System> system;
  lattice::Lattice lattice;
  State state;
  Workspace workspace;
  ThreadArena arena;
  uint64_t done = 0;
};

inline lattice::SideDef side(lattice::SideKind kind, const std::string& value = "0", double transfer = 1) {
  return {kind, value, transfer};
}

}  // namespace truestep::test
