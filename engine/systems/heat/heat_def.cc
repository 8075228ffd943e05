#include "engine/systems/heat/heat_def.h"

namespace truestep::heat {

const DefTable& heat_table() {
  using D = HeatDef;
  static const DefTable kTable = [] {
    TableOf<D> t("heat conduction in a box of one to three dimensions");
    lattice::add_lattice_rows(t, "temperature at the start, an expression of x, y, z",
                              "heating in K/s, an expression of x, y, z and t");
    t.expression("diffusivity", &D::diffusivity, "m^2/s, a positive number or an expression of x, y, z and t")
        .number("heat_capacity", &D::heat_capacity, "1", above(0),
                "energy per temperature and length, area or volume, J/(K m^d)");
    add_integrator_rows(t);
    return t.check([](const D& d, const DefTable::Report& report) { lattice::check_lattice(d, report); })
        .build();
  }();
  return kTable;
}

Cost heat_cost(const void* def) {
  const auto& d = *static_cast<const HeatDef*>(def);
  const double n = lattice::lattice_nodes(d);
  Cost c;
  c.state_bytes = 8 * n + 2e3;
  c.workspace_bytes = lattice::lattice_workspace_bytes(d, "rk4");
  c.elements = n;
  c.seconds_per_step = lattice::lattice_step_seconds(d, "rk4");
  return c;
}

}  // namespace truestep::heat
