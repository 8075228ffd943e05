#include "engine/lattice/diffusion.h"

#include <algorithm>
#include <cmath>

#include "engine/kernels/stencil.h"

namespace truestep::lattice {

Diffusion::Diffusion(const Lattice& lattice, int order, Coefficient c)
    : lattice_(lattice), order_(order), c_(std::move(c)) {
  const stencil::SecondDerivative d = order == 4 ? stencil::kOrder4 : stencil::kOrder2;
  for (size_t a = 0; a < lattice_.dimensions; ++a) {
    const Axis& axis = lattice_.axes[a];
    const auto n = static_cast<ptrdiff_t>(axis.nodes()), last = static_cast<ptrdiff_t>(axis.cells);
    taps_[a].resize(axis.nodes());
    for (ptrdiff_t i = 0; i < n; ++i) {
      Taps& t = taps_[a][static_cast<size_t>(i)];
      t.index.fill(static_cast<uint32_t>(i));
      t.weight = {d.far, d.near, d.centre, d.near, d.far};
      for (ptrdiff_t m = 0; m < 5; ++m) {
        ptrdiff_t to = i + m - 2;
        double& w = t.weight[static_cast<size_t>(m)];
        if (w == 0) continue;
        if (axis.periodic()) {
          to = (to + n) % n;
        } else if (to < 0 || to > last) {
          const ptrdiff_t end = to < 0 ? 0 : last;
          to = 2 * end - to;
          if (axis.sides[end == 0 ? 0 : 1].kind == SideKind::dirichlet) {
            // u(-s) = 2 u(0) - u(s): the end's own tap gets twice the weight. This affects the nodes next to
            // the end.
            for (ptrdiff_t e = 0; e < 5; ++e) {
              if (i + e - 2 == end) t.weight[static_cast<size_t>(e)] += 2 * w;
            }
            w = -w;
          }
        }
        t.index[static_cast<size_t>(m)] = static_cast<uint32_t>(to);
      }
      for (size_t s = 0; s < 2; ++s) {
        if (i == (s == 0 ? 0 : last) && axis.sides[s].kind == SideKind::robin) {
          t.weight[2] -= 2 * axis.spacing * axis.sides[s].transfer;
        }
      }
    }
  }
}

void Diffusion::apply(const double* u, double* out, double identity, double step,
                      const ThreadArena& arena) const {
  const size_t nx = lattice_.count(0), ny = lattice_.count(1), rows = ny * lattice_.count(2);
  const size_t block = std::max<size_t>(1, 4 * kBlockRows / nx);
  arena.for_blocks(rows, block, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) apply_row(u, out + r * nx, identity, step, r % ny, r / ny);
  });
}

void Diffusion::step_in_place(double* u, double step, std::vector<double>& waiting) const {
  const size_t nx = lattice_.count(0), ny = lattice_.count(1), rows = ny * lattice_.count(2);
  // Rows up to this far behind a row still read it; with periodic sides the last rows also read the first.
  const size_t far = (order_ == 4 ? 2 : 1) * (lattice_.dimensions == 3 ? ny : 1);
  const size_t first = std::min(rows, far), ring = far + 1;
  waiting.resize((first + ring) * nx);
  const auto place = [&](size_t r) { return waiting.data() + (r < first ? r : first + r % ring) * nx; };
  for (size_t r = 0; r < rows; ++r) {
    apply_row(u, place(r), 1, step, r % ny, r / ny);
    if (r >= far + first) std::copy_n(place(r - far), nx, u + (r - far) * nx);
  }
  for (size_t r = std::max(first, rows - std::min(rows, far)); r < rows; ++r) {
    std::copy_n(place(r), nx, u + r * nx);
  }
  for (size_t r = 0; r < first; ++r) std::copy_n(place(r), nx, u + r * nx);
}

void Diffusion::leapfrog_in_place(double* x, double* v, double h, std::vector<double>& row) const {
  const size_t nx = lattice_.count(0), ny = lattice_.count(1), rows = ny * lattice_.count(2);
  // As above; the first rows also read the last, which therefore drift before them and once more at the end.
  const size_t far = (order_ == 4 ? 2 : 1) * (lattice_.dimensions == 3 ? ny : 1);
  const size_t first = std::min(rows, far), last = std::max(first, rows - std::min(rows, far));
  row.resize(nx);
  double* a = row.data();
  const auto drift = [&](size_t r) {
    double* xs = x + r * nx;
    const double* vs = v + r * nx;
    for (size_t i = 0; i < nx; ++i) xs[i] = std::fma(0.5 * h, vs[i], xs[i]);
  };
  const auto drift_ends = [&] {
    for (size_t r = 0; r < first; ++r) drift(r);
    for (size_t r = last; r < rows; ++r) drift(r);
  };
  drift_ends();
  for (size_t r = 0; r < rows; ++r) {
    if (r + far < last) drift(r + far);
    apply_row(x, a, 0, 1, r % ny, r / ny);
    double* vs = v + r * nx;
    for (size_t i = 0; i < nx; ++i) vs[i] = std::fma(h, a[i], vs[i]);
    if (r >= far + first && r - far < last) drift(r - far);
  }
  drift_ends();
}

void Diffusion::apply_end(const double* u, double* row, double identity, double step,
                          const std::array<size_t, 3>& p) const {
  const size_t node = p[0] + lattice_.stride(1) * p[1] + lattice_.stride(2) * p[2];
  double sum = 0;
  entries(p, [&](size_t to, double w) { sum += w * u[to]; });
  row[p[0]] = identity * u[node] + step * sum;
}

void Diffusion::apply_row(const double* u, double* out_row, double identity, double step, size_t j,
                          size_t k) const {
  const size_t nx = lattice_.count(0), d = lattice_.dimensions;
  const std::array<size_t, 3> strides = {1, lattice_.stride(1), lattice_.stride(2)};
  const size_t start = j * strides[1] + k * strides[2];
  const std::array<size_t, 3> at = {0, j, k};
  for (size_t a = 1; a < d; ++a) {
    if (!lattice_.axes[a].fixed(at[a])) continue;
    for (size_t i = 0; i < nx; ++i) out_row[i] = identity * u[start + i];
    return;
  }
  // Nodes near the ends of the row are computed one by one.
  const size_t reach = order_ == 4 ? 2 : 1;
  const size_t low = std::min(reach, nx), high = std::max(low, nx - std::min(reach, nx));
  if (c_.variable()) {
    for (size_t i = 0; i < low; ++i) apply_end(u, out_row, identity, step, {i, j, k});
    for (size_t i = high; i < nx; ++i) apply_end(u, out_row, identity, step, {i, j, k});
    stencil::Neighbour neighbours[4];
    size_t count = 0;
    // A Robin side along y or z adds to the diagonal: such rows are computed one by one as well.
    for (size_t a = 1; a < d; ++a) {
      const Axis& axis = lattice_.axes[a];
      const double scale = 1 / (axis.spacing * axis.spacing);
      const size_t i = at[a], line = start - i * strides[a];
      if ((i == 0 && axis.sides[0].kind == SideKind::robin) ||
          (i == axis.cells && axis.sides[1].kind == SideKind::robin)) {
        for (size_t x = low; x < high; ++x) apply_end(u, out_row, identity, step, {x, j, k});
        return;
      }
      neighbours[count++] = {u + line + axis.before(i) * strides[a],
                             c_.faces[a].data() + line + axis.face_before(i) * strides[a], scale};
      neighbours[count++] = {u + line + axis.after(i) * strides[a],
                             c_.faces[a].data() + line + axis.face_after(i) * strides[a], scale};
    }
    const double scale = 1 / (lattice_.axes[0].spacing * lattice_.axes[0].spacing);
    const double* face = c_.faces[0].data() + start;
    const auto run = [&]<int kRows>() {
      stencil::conserve_row<kRows>(u + start, face, scale, neighbours, identity, step, out_row, low, high);
    };
    return d == 1 ? run.operator()<0>() : d == 2 ? run.operator()<2>() : run.operator()<4>();
  }
  const stencil::SecondDerivative w = order_ == 4 ? stencil::kOrder4 : stencil::kOrder2;
  const auto scale = [&](size_t a) {
    const double h = lattice_.axes[a].spacing;
    return step * c_.constant / (h * h);
  };
  stencil::RowWeights row;
  row.centre = identity + scale(0) * w.centre, row.near = scale(0) * w.near, row.far = scale(0) * w.far;
  size_t count = 0;
  for (size_t a = 1; a < d; ++a) {
    const Taps& t = taps_[a][at[a]];
    const size_t line = start - at[a] * strides[a];
    row.centre += scale(a) * t.weight[2];
    for (size_t m = 2 - reach; m <= 2 + reach; ++m) {
      if (m == 2) continue;
      row.rows[count] = u + line + t.index[m] * strides[a];
      row.weights[count++] = scale(a) * t.weight[m];
    }
  }
  // The node's own weight without the contribution of x.
  const double around = row.centre - scale(0) * w.centre;
  const auto end = [&](size_t i) {
    if (lattice_.axes[0].fixed(i)) {
      out_row[i] = identity * u[start + i];
      return;
    }
    const Taps& t = taps_[0][i];
    double along = 0, across = around * u[start + i];
    for (size_t m = 0; m < 5; ++m) along += t.weight[m] * u[start + t.index[m]];
    for (size_t m = 0; m < count; ++m) across += row.weights[m] * row.rows[m][i];
    out_row[i] = across + scale(0) * along;
  };
  for (size_t i = 0; i < low; ++i) end(i);
  for (size_t i = high; i < nx; ++i) end(i);
  const auto run = [&]<int kReach, int kRows>() {
    stencil::combine_row<kReach, kRows>(u + start, row, out_row, low, high);
  };
  if (order_ == 4) {
    return d == 1 ? run.operator()<2, 0>() : d == 2 ? run.operator()<2, 4>() : run.operator()<2, 8>();
  }
  return d == 1 ? run.operator()<1, 0>() : d == 2 ? run.operator()<1, 2>() : run.operator()<1, 4>();
}

double Diffusion::spectral_radius() const {
  if (!c_.variable()) {
    // Sum over the axes: 4 and 16/3 at the shortest wave, or the diagonal's own bound where Robin sides make
    // it larger.
    double sum = 0;
    for (size_t a = 0; a < lattice_.dimensions; ++a) {
      double most = order_ == 4 ? 16.0 / 3 : 4.0;
      for (const Taps& t : taps_[a]) {
        if (order_ == 2) most = std::max(most, 2 - t.weight[2]);
      }
      sum += most * c_.constant / (lattice_.axes[a].spacing * lattice_.axes[a].spacing);
    }
    return sum;
  }
  double most = 0;
  for (size_t node = 0; node < lattice_.nodes(); ++node) {
    double sum = 0;
    entries(lattice_.place(node), [&](size_t, double w) { sum += std::abs(w); });
    most = std::max(most, sum);
  }
  return most;
}

Diffusion::Matrix Diffusion::matrix() const {
  const size_t n = lattice_.nodes();
  // Row by row with merged entries, then transposed to columns.
  std::vector<std::vector<std::pair<int32_t, double>>> columns(n);
  std::vector<std::pair<size_t, double>> row;
  for (size_t node = 0; node < n; ++node) {
    row.clear();
    entries(lattice_.place(node), [&](size_t to, double w) {
      const auto known = std::ranges::find(row, to, &std::pair<size_t, double>::first);
      if (known != row.end()) {
        known->second += w;
      } else {
        row.emplace_back(to, w);
      }
    });
    // The diagonal is part of every pattern.
    if (row.empty()) row.emplace_back(node, 0.0);
    for (const auto& [to, w] : row) columns[to].emplace_back(static_cast<int32_t>(node), w);
  }
  Matrix m;
  m.column_start.push_back(0);
  for (const auto& column : columns) {
    for (const auto& [to, w] : column) m.rows.push_back(to), m.values.push_back(w);
    m.column_start.push_back(static_cast<int32_t>(m.rows.size()));
  }
  return m;
}

}  // namespace truestep::lattice
