// A system on a lattice stepped without a session around it.
#pragma once
#include <cmath>
#include <memory>
#include <string>

#include "engine/systems/heat/heat.h"
#include "engine/systems/wave/wave.h"
#include "tests/support/runs/system_run.h"

namespace truestep::test {

struct FieldRun : testing_rig::SystemRun<std::unique_ptr<const System>> {
  FieldRun(const heat::HeatDef& d, double dt, int threads = 1)
      : SystemRun([&] { return heat::build_heat(&d, {.id = "field", .dt = dt}); }, dt, threads),
        lattice(static_cast<const heat::Heat&>(*system).model().lattice()) {}
  FieldRun(const wave::WaveDef& d, double dt, int threads = 1)
      : SystemRun([&] { return wave::build_wave(&d, {.id = "field", .dt = dt}); }, dt, threads),
        lattice(static_cast<const wave::Wave&>(*system).model().lattice()) {}
  void steps(uint64_t n) { step(n); }
  uint64_t& done() { return SystemRun::steps; }
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

  lattice::Lattice lattice;
};

inline lattice::SideDef side(lattice::SideKind kind, const std::string& value = "0", double transfer = 1) {
  return {kind, value, transfer};
}

}  // namespace truestep::test
