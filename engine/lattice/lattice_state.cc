#include "engine/lattice/lattice_state.h"

#include <algorithm>
#include <cmath>

#include "engine/core/commands/command_checks.h"

namespace truestep::lattice {

State::Column add_column(State& state, ColumnInfo info, const std::vector<double>& values) {
  const auto c = state.add(std::move(info), values.size());
  std::ranges::copy(values, state.f64(c).begin());
  return c;
}

PartInfo grid_part(const Lattice& lattice, std::vector<FieldInfo> fields) {
  PartInfo part;
  part.kind = PartInfo::Kind::grid;
  part.fields = std::move(fields);
  part.max_rows = lattice.nodes();
  double spacing[3] = {1, 1, 1};
  for (size_t a = 0; a < 3; ++a) {
    part.lattice.counts[a] = static_cast<uint32_t>(lattice.count(a));
    if (a < lattice.dimensions) spacing[a] = lattice.axes[a].spacing;
  }
  part.lattice.origin = {lattice.axes[0].origin, lattice.axes[1].origin, lattice.axes[2].origin};
  part.lattice.spacing = {spacing[0], spacing[1], spacing[2]};
  return part;
}

double integral(const Lattice& l, std::span<const double> u) {
  const size_t nx = l.count(0), rows = l.count(1) * l.count(2);
  double total = 0;
  for (size_t r = 0; r < rows; ++r) {
    const double* row = u.data() + r * nx;
    double sum = 0;
    for (size_t i = 0; i < nx; ++i) sum += l.axes[0].share(i) * row[i];
    total += sum * l.volume({1, r % l.count(1), r / l.count(1)});
  }
  return total;
}

void add_at(const Lattice& l, const Command& c, double amount, std::span<double> u) {
  const auto add = [&](const std::array<size_t, 3>& p, double part) {
    u[p[0] + l.stride(1) * p[1] + l.stride(2) * p[2]] += part / l.volume(p);
  };
  if (!c.at) {
    const auto p = l.place(checked_command_row(c, l.nodes(), "node"));
    if (l.fixed(p)) refuse_command("index", "fixed", "the value of this node is set by its side");
    return add(p, amount);
  }
  const double at[] = {c.at->x, c.at->y, c.at->z};
  std::array<size_t, 3> base{};
  std::array<double, 3> part{};
  for (size_t a = 0; a < l.dimensions; ++a) {
    const Axis& axis = l.axes[a];
    const double s = (at[a] - axis.origin) / axis.spacing;
    if (!(s >= 0 && s <= static_cast<double>(axis.cells))) {
      refuse_command("at", "out_of_range", "the point lies outside the box");
    }
    base[a] = std::min(static_cast<size_t>(s), axis.cells - 1);
    part[a] = s - static_cast<double>(base[a]);
  }
  for (size_t corner = 0; corner < (size_t{1} << l.dimensions); ++corner) {
    std::array<size_t, 3> p{};
    double w = 1;
    for (size_t a = 0; a < l.dimensions; ++a) {
      const bool high = (corner >> a) & 1;
      p[a] = high ? l.axes[a].after(base[a]) : base[a];
      w *= high ? part[a] : 1 - part[a];
    }
    if (w > 0 && !l.fixed(p)) add(p, w * amount);
  }
}

}  // namespace truestep::lattice
