#include "engine/systems/heightfield_wave/heightfield_wave_def.h"

#include "engine/lattice/divide_cells.h"

namespace truestep::heightfield_wave {

namespace {
constexpr const char* kSideNames[2][2] = {{"x_min", "x_max"}, {"y_min", "y_max"}};
constexpr double kMostCells = 5e7;

double cell_count(const HeightfieldWaveDef& d) {
  double n = 1;
  for (const int64_t c : d.cells) n *= static_cast<double>(c);
  return n;
}

const DefTable& edge_table() {
  static const DefTable kTable =
      TableOf<EdgeDef>("the condition on a side")
          .choice("kind", &EdgeDef::kind, {"wall", "open", "periodic"},
                  "wall: waves are reflected; open: they leave; periodic: they re-enter at the other end")
          .build();
  return kTable;
}

const DefTable& edges_table() {
  using D = EdgesDef;
  static const DefTable kTable = TableOf<D>("the sides of the basin")
                                     .object("x_min", &D::x_min, edge_table(), "side at the smallest x")
                                     .object("x_max", &D::x_max, edge_table(), "side at the largest x")
                                     .object("y_min", &D::y_min, edge_table(), "side at the smallest y")
                                     .object("y_max", &D::y_max, edge_table(), "side at the largest y")
                                     .build();
  return kTable;
}

void check_basin(const HeightfieldWaveDef& d, const DefTable::Report& report) {
  if (!d.size.empty() && d.size.size() != d.cells.size())
    report("/size", "needs as many lengths as there are axes in cells");
  if (cell_count(d) > kMostCells) report("/cells", "more than 5e7 cells");
  if (!d.velocity.empty() && d.velocity.size() != d.cells.size())
    report("/velocity", "needs as many components as the basin has dimensions");
  for (size_t a = 0; a < 2; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const std::string pointer = std::string("/sides/") + kSideNames[a][end];
      if (a >= d.cells.size()) {
        if (d.sides.of(a, end)) report(pointer, "the basin has no such side");
      } else if (edge_of(d, a, end) == EdgeDef::Kind::periodic &&
                 edge_of(d, a, 1 - end) != EdgeDef::Kind::periodic) {
        report(pointer, "a periodic side needs a periodic opposite side");
      }
    }
  }
}
}  // namespace

const std::optional<EdgeDef>& EdgesDef::of(size_t axis, size_t end) const {
  const std::optional<EdgeDef>* const all[] = {&x_min, &x_max, &y_min, &y_max};
  return *all[2 * axis + end];
}

EdgeDef::Kind edge_of(const HeightfieldWaveDef& d, size_t axis, size_t end) {
  if (const auto& own = d.sides.of(axis, end)) return own->kind;
  // A periodic end makes the other one periodic.
  if (const auto& other = d.sides.of(axis, 1 - end); other && other->kind == EdgeDef::Kind::periodic)
    return other->kind;
  return d.all.value_or(EdgeDef{}).kind;
}

shallow::Basin make_basin(const HeightfieldWaveDef& d) {
  shallow::Basin b;
  b.dimensions = d.cells.size();
  for (size_t a = 0; a < b.dimensions; ++a) {
    b.cells[a] = static_cast<size_t>(d.cells[a]);
    b.spacing[a] = (d.size.empty() ? 1 : d.size[a]) / static_cast<double>(b.cells[a]);
    if (d.origin) b.origin[a] = a == 0 ? d.origin->x : d.origin->y;
    for (size_t end = 0; end < 2; ++end) b.edges[a][end] = static_cast<shallow::Edge>(edge_of(d, a, end));
  }
  return b;
}

const DefTable& heightfield_wave_table() {
  using D = HeightfieldWaveDef;
  static const DefTable kTable =
      TableOf<D>("shallow water over a bed: its depth and mean velocity; heights are along z")
          .integers("cells", &D::cells, between(4, 1e6), {1, 2}, "cells along x, or x and y")
          .numbers("size", &D::size, "m", above(0), {0, 2},
                   "lengths of the basin; absent: 1 along every axis")
          .vector("origin", &D::origin, "m", any(), "lower corner of the basin; heights are above its z")
          .object("side", &D::all, edge_table(),
                  "all sides without their own entry in `sides`; absent: walls")
          .object("sides", &D::sides, edges_table(), "individual sides")
          .expression("bed", &D::bed, "m, height of the ground, an expression of x and y")
          .expression("surface", &D::surface,
                      "m, initial height of the water's surface, an expression of x and y; the ground is dry "
                      "where the bed is higher")
          .texts("velocity", &D::velocity, {0, 2}, "m/s, initial velocity: expressions of x and y")
          .expression("exact", &D::exact, "m, exact height of the surface, an expression of x, y and t")
          .number("friction", &D::friction, "1", at_least(0),
                  "of the bed: its drag is this times density times squared speed")
          .number("density", &D::density, "kg/m^3", above(0), "mass per volume")
          .number("cfl", &D::cfl, "1", between(1e-3, 0.5),
                  "cells that the fastest wave may cross per substep, summed over the axes; depths stay "
                  "positive up to 0.5")
          .number("dry_depth", &D::dry_depth, "m", above(0),
                  "depth up to which water is at rest; absent: a millionth of the largest initial depth")
          .check(check_basin)
          .build();
  return kTable;
}

double heightfield_substep_seconds(const HeightfieldWaveDef& d) {
  // Measured on one core: a substep of two stages.
  return 2e-6 + 6e-8 * cell_count(d);
}

Cost heightfield_wave_cost(const void* def) {
  const auto& d = *static_cast<const HeightfieldWaveDef*>(def);
  double padded = 1;
  for (const int64_t c : d.cells) padded *= static_cast<double>(c) + 2.0 * shallow::Basin::kGhosts;
  const double n = cell_count(d), unknowns = d.cells.size() == 2 ? 3 : 2;
  Cost c;
  c.state_bytes = 8 * n * unknowns + 2e3;
  // Bed and four more arrays with ghosts; rates and the substep's initial state.
  c.workspace_bytes = 8 * (6 * padded + 2 * unknowns * n) + 3e4;
  c.elements = n;
  c.seconds_per_step = heightfield_substep_seconds(d);
  return c;
}

const Resolution& heightfield_wave_resolution() {
  static const Resolution kCells{.parameter = "cells",
                                 .divide =
                                     [](void* def, double factor) {
                                       return divide_cells(static_cast<HeightfieldWaveDef*>(def)->cells,
                                                           factor, 4);
                                     },
                                 .order = [](const void*) { return 2; }};
  return kCells;
}

}  // namespace truestep::heightfield_wave
