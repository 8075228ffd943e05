// The table of what a flow gives out.
#include "engine/systems/grid_fluid/fluid_rows.h"
#include "engine/systems/grid_fluid/grid_fluid.h"
#include "engine/systems/grid_fluid/liquid/liquid.h"

namespace truestep::grid_fluid {

const OutputTable& GridFluid::outputs() {
  using G = GridFluid;
  const auto cells_of = [](std::optional<State::Column> G::*kept) {
    return computed_by<G>(
        [kept](const G& g, const State& s, ShownRows, double* out) { g.copy_cells(s, *(g.*kept), out); });
  };
  static const OutputTable kTable =
      OutputsOf<G>("a cell, x fastest; of a liquid a particle")
          .part("", &G::cells)
          .field({"velocity", "m/s", Scalar::f64, 3}, computed_by<G>(&G::velocity),
                 "velocity at the cell's centre")
          .field({"speed", "m/s"}, computed_by<G>(&G::speed), "its magnitude")
          .field({"pressure", "Pa"}, computed_by<G>(&G::pressure), "pressure")
          .field({.name = "vorticity", .unit = "1/s", .scale = FieldInfo::Scale::deviation},
                 computed_by<G>(&G::vorticity),
                 "curl of the velocity: along z in the plane, its magnitude in space")
          .field({"scalar", "1"}, cells_of(&G::scalar_), "what the flow carries")
          .field_when([](const G& g) { return g.scalar_.has_value(); })
          .field({"second_fluid", "1"}, cells_of(&G::second_),
                 "fraction of a cell filled by the second fluid")
          .field_when([](const G& g) { return g.second_.has_value(); })
          .measured(&G::measure, kFluidRows)
          .build();
  return kTable;
}

const Outputs& grid_fluid_outputs() {
  static const Outputs kDescribed = GridFluid::outputs().described_with(Liquid::outputs());
  return kDescribed;
}

PartInfo GridFluid::cells() const {
  const mac::MacGrid& g = model_.grid;
  PartInfo part;
  part.kind = PartInfo::Kind::grid;
  part.max_rows = g.cell_count();
  double first[3] = {g.origin[0], g.origin[1], g.origin[2]}, spacing[3] = {1, 1, 1};
  for (size_t a = 0; a < 3; ++a) {
    part.lattice.counts[a] = static_cast<uint32_t>(g.cells[a]);
    if (a < g.dimensions) first[a] = g.coordinate(mac::kCentre, a, 0), spacing[a] = g.spacing[a];
  }
  part.lattice.origin = {first[0], first[1], first[2]};
  part.lattice.spacing = {spacing[0], spacing[1], spacing[2]};
  part.lattice.centring = Lattice::Centring::cells;
  return part;
}

}  // namespace truestep::grid_fluid
