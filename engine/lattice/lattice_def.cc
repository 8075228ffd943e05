#include "engine/lattice/lattice_def.h"

#include "engine/integrators/table/integrators.h"

#include <cmath>

namespace truestep::lattice {

namespace {
constexpr double kMostNodes = 5e7;
}  // namespace

const DefTable& side_table() {
  using D = SideDef;
  static const DefTable kTable =
      TableOf<D>("the condition on a side")
          .choice("kind", &D::kind, {"dirichlet", "neumann", "robin", "periodic"},
                  "dirichlet: u = value; neumann: du/dn = value, n pointing outwards; robin: du/dn = "
                  "transfer (value - u); periodic: u continues at the other end")
          .expression("value", &D::value, "expression of x, y, z and t")
          .number("transfer", &D::transfer, "1/m", at_least(0), "of a robin side")
          .build();
  return kTable;
}

namespace {
const SideDef* side_of(const LatticeDef& d, size_t axis, size_t end) {
  if (const auto& own = d.sides.of(axis, end)) return &*own;
  // If one end is periodic, so is the other.
  if (const auto& other = d.sides.of(axis, 1 - end); other && other->kind == SideKind::periodic) {
    return &*other;
  }
  return d.all ? &*d.all : nullptr;
}
}  // namespace

std::string side_value(const LatticeDef& d, size_t axis, size_t end) {
  const SideDef* s = side_of(d, axis, end);
  return s ? s->value : "0";
}

Lattice make_lattice(const LatticeDef& d, SideKind usual) {
  Lattice l;
  l.dimensions = d.cells.size();
  if (d.origin)
    l.axes[0].origin = d.origin->x, l.axes[1].origin = d.origin->y, l.axes[2].origin = d.origin->z;
  for (size_t a = 0; a < l.dimensions; ++a) {
    Axis& axis = l.axes[a];
    axis.cells = static_cast<size_t>(d.cells[a]);
    const double length = d.size.empty() ? 1 : d.size[a];
    axis.spacing = length / static_cast<double>(axis.cells);
    for (size_t end = 0; end < 2; ++end) {
      const SideDef* s = side_of(d, a, end);
      axis.sides[end] = {s ? s->kind : usual, s && s->kind == SideKind::robin ? s->transfer : 0};
    }
  }
  return l;
}

double lattice_nodes(const LatticeDef& d) {
  double n = 1;
  for (const int64_t c : d.cells) n *= static_cast<double>(c) + 1;
  return n;
}

double lattice_workspace_bytes(const LatticeDef& d, std::string_view usual) {
  // Measured: arrays of one number per node that explicit methods keep, and that implicit ones keep with
  // their solver.
  constexpr double kExplicit = 9, kImplicit = 40;
  const Integrator* m = find_integrator(d.integrator.empty() ? usual : std::string_view(d.integrator));
  return 8 * lattice_nodes(d) * (m && m->kind == Integrator::Kind::implicit ? kImplicit : kExplicit);
}

double lattice_step_seconds(const LatticeDef& d, std::string_view usual) {
  // Measured on one core: time of an evaluation per row of the lattice and per node including the sums around
  // it, and of a solve by transforms or multigrid.
  constexpr double kBase = 1e-6, kRow = 2e-8, kNode = 1.7e-9, kWideNode = 2.1e-9, kSolve = 4e-8;
  const Integrator* m = find_integrator(d.integrator.empty() ? usual : std::string_view(d.integrator));
  if (!m) return kBase;
  const bool adaptive = m->stepping == Integrator::Stepping::adaptive;
  const double times = adaptive ? 12 : m->order < 4 ? 2 : 3;
  const double node = (d.order == LatticeDef::Order::fourth ? kWideNode : kNode) +
                      (m->kind == Integrator::Kind::implicit ? kSolve : 0);
  const double nodes = lattice_nodes(d), rows = nodes / (static_cast<double>(d.cells[0]) + 1);
  // The comparison with an exact solution is made at every observation.
  const double exact = d.exact.empty() ? 0 : 2e-8 * nodes;
  return kBase + times * (kRow * rows + node * nodes) + exact;
}

void check_lattice(const LatticeDef& d, const DefTable::Report& report) {
  if (!d.size.empty() && d.size.size() != d.cells.size()) {
    report("/size", "needs as many lengths as there are axes in cells");
  }
  if (lattice_nodes(d) > kMostNodes) report("/cells", "more than 5e7 nodes");
  const bool fourth = d.order == LatticeDef::Order::fourth;
  for (size_t a = 0; a < 3; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const std::string pointer = std::string("/sides/") + kSideNames[a][end];
      if (a >= d.cells.size()) {
        if (d.sides.of(a, end)) report(pointer, "the box has no such side");
        continue;
      }
      const SideDef *mine = side_of(d, a, end), *other = side_of(d, a, 1 - end);
      const bool periodic = mine && mine->kind == SideKind::periodic;
      if (periodic && !(other && other->kind == SideKind::periodic)) {
        report(pointer, "a periodic side needs a periodic opposite side");
      }
      if (fourth && mine && mine->kind == SideKind::robin) {
        report(d.sides.of(a, end) ? pointer : "/side", "robin sides need order 2 in space");
      }
      if (periodic && d.cells[a] < 3) report("/cells", "a periodic axis needs at least 3 cells");
    }
    if (a < d.cells.size() && fourth && d.cells[a] < 5) {
      report("/cells", "order 4 needs at least 5 cells along every axis");
    }
  }
}

}  // namespace truestep::lattice
