// -1/2 u L u as a sum over faces of c (difference)^2 / 2, and in fourth order over nodes of c (second
// difference)^2 / 24. Squares are added element by element over the rows of the lattice, and along the row
// last, so that the loops vectorize and the order of the sums is fixed.
#include <algorithm>

#include "engine/lattice/diffusion.h"

namespace truestep::lattice {

namespace {

// sums += weight c (b - a)^2; c has one number per element, or is null.
void add_differences(const double* a, const double* b, const double* c, double weight, double* sums,
                     size_t n) {
  if (c) {
#pragma GCC ivdep
    for (size_t i = 0; i < n; ++i) sums[i] += weight * c[i] * ((b[i] - a[i]) * (b[i] - a[i]));
  } else {
#pragma GCC ivdep
    for (size_t i = 0; i < n; ++i) sums[i] += weight * ((b[i] - a[i]) * (b[i] - a[i]));
  }
}

// sums += weight (before - 2 u + after)^2
void add_curvatures(const double* before, const double* u, const double* after, double weight, double* sums,
                    size_t n) {
#pragma GCC ivdep
  for (size_t i = 0; i < n; ++i) {
    const double d = before[i] + after[i] - 2 * u[i];
    sums[i] += weight * (d * d);
  }
}

}  // namespace

double Diffusion::potential(const double* u, std::vector<double>& sums) const {
  const size_t nx = lattice_.count(0), d = lattice_.dimensions;
  sums.assign(2 * nx, 0);
  // For faces across x, and for terms weighted by a node's share of the row.
  double *along = sums.data(), *across = along + nx;
  const double steady = c_.variable() ? 1 : c_.constant;
  const auto faces = [&](size_t axis, size_t node) {
    return c_.variable() ? c_.faces[axis].data() + node : nullptr;
  };
  const auto robin = [&](const Axis& axis, size_t i) {
    for (size_t s = 0; s < 2; ++s) {
      if (i == (s == 0 ? 0 : axis.cells) && axis.sides[s].kind == SideKind::robin) {
        return 0.5 * axis.sides[s].transfer;
      }
    }
    return 0.0;
  };
  const Axis& x = lattice_.axes[0];
  for (size_t r = 0; r < lattice_.count(1) * lattice_.count(2); ++r) {
    const std::array<size_t, 3> at = {0, r % lattice_.count(1), r / lattice_.count(1)};
    const size_t start = r * nx;
    const double* row = u + start;
    double area = 1;  // of the row, perpendicular to x
    for (size_t a = 1; a < d; ++a) area *= lattice_.axes[a].spacing * lattice_.axes[a].share(at[a]);

    const double weight = 0.5 * area * steady / x.spacing;
    add_differences(row, row + 1, faces(0, start), weight, along, nx - 1);
    if (x.periodic()) {
      const double* c = faces(0, start + nx - 1);
      add_differences(row + nx - 1, row, c, weight, along + nx - 1, 1);
    }
    for (const size_t i : {size_t{0}, nx - 1}) {
      if (const double w = robin(x, i)) along[i] += w * area * c_.at(start + i) * row[i] * row[i];
    }
    if (order_ == 4) {
      const double bend = c_.constant * area / (24 * x.spacing * x.spacing);
      add_curvatures(row, row + 1, row + 2, bend, across + 1, nx - std::min<size_t>(nx, 2));
      for (const size_t i : {size_t{0}, nx - 1}) {
        if (!x.fixed(i)) add_curvatures(row + x.before(i), row + i, row + x.after(i), bend, across + i, 1);
      }
    }
    for (size_t a = 1; a < d; ++a) {
      const Axis& axis = lattice_.axes[a];
      const size_t i = at[a], stride = lattice_.stride(a), line = start - i * stride;
      const double own = area / (axis.spacing * axis.share(i));
      if (axis.periodic() || i < axis.cells) {
        add_differences(row, u + line + axis.after(i) * stride, faces(a, start),
                        0.5 * own * steady / axis.spacing, across, nx);
      }
      if (const double w = robin(axis, i)) {
        for (size_t e = 0; e < nx; ++e) across[e] += w * own * c_.at(start + e) * row[e] * row[e];
      }
      if (order_ == 4 && !axis.fixed(i)) {
        add_curvatures(u + line + axis.before(i) * stride, row, u + line + axis.after(i) * stride,
                       c_.constant * area / (24 * axis.spacing * axis.spacing), across, nx);
      }
    }
  }
  double total = 0;
  for (size_t i = 0; i < nx; ++i) total += along[i] + x.spacing * x.share(i) * across[i];
  return total;
}

}  // namespace truestep::lattice
