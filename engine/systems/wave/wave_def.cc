#include "engine/systems/wave/wave_def.h"

namespace truestep::wave {

const DefTable& wave_table() {
  using D = WaveDef;
  static const DefTable kTable = [] {
    TableOf<D> t("waves in a box of one to three dimensions: strings, membranes, ponds, sound");
    lattice::add_lattice_rows(t, "displacement at the start, an expression of x, y, z",
                              "acceleration in m/s^2, an expression of x, y, z and t");
    t.expression("speed", &D::speed, "m/s, a positive number or an expression of x, y, z and t")
        .expression("initial_rate", &D::initial_rate, "velocity at the start, an expression of x, y, z")
        .number("damping", &D::damping, "1/s", at_least(0), "deceleration per velocity");
    add_integrator_rows(t);
    return t.check([](const D& d, const DefTable::Report& report) { lattice::check_lattice(d, report); })
        .build();
  }();
  return kTable;
}

Cost wave_cost(const void* def) {
  const auto& d = *static_cast<const WaveDef*>(def);
  const double n = lattice::lattice_nodes(d);
  Cost c;
  c.state_bytes = 16 * n + 2e3;
  c.workspace_bytes = lattice::lattice_workspace_bytes(d, "leapfrog");
  c.elements = n;
  // Includes monitoring their energy.
  c.seconds_per_step = lattice::lattice_step_seconds(d, "leapfrog");
  return c;
}

}  // namespace truestep::wave
