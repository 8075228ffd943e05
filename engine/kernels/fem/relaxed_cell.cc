#include "engine/kernels/fem/relaxed_cell.h"

#include <algorithm>
#include <cmath>

namespace truestep::fem {

namespace {

/// L D L^T of the symmetric n x n matrix a (row by row, overwritten); false if not positive definite.
bool factorise(double* a, size_t n) {
  for (size_t j = 0; j < n; ++j) {
    double d = a[j * n + j];
    const double own = d;
    for (size_t k = 0; k < j; ++k) d -= a[j * n + k] * a[j * n + k] * a[k * n + k];
    if (!(d > 1e-14 * own)) return false;
    a[j * n + j] = d;
    for (size_t i = j + 1; i < n; ++i) {
      double s = a[i * n + j];
      for (size_t k = 0; k < j; ++k) s -= a[i * n + k] * a[j * n + k] * a[k * n + k];
      a[i * n + j] = s / d;
    }
  }
  return true;
}

void solve(const double* a, size_t n, double* b) {
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < i; ++k) b[i] -= a[i * n + k] * b[k];
  }
  for (size_t i = 0; i < n; ++i) b[i] /= a[i * n + i];
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; ++k) b[i] -= a[k * n + i] * b[k];
  }
}

/// Component (row, column) of the node blocks in the layout of cell_stiffness.
double entry(const double* k, size_t all, size_t row, size_t column) {
  return k[9 * (row / 3 * all + column / 3) + 3 * (column % 3) + row % 3];
}

}  // namespace

RelaxedCell::RelaxedCell(const Material& material, const CellRule& rule, const Vec3* x)
    : nodes_(rule.nodes), modes_(rule.modes), rule_(rule) {
  const size_t all = nodes_ + modes_;
  for (size_t q = 0; q < rule.points; ++q) {
    std::copy_n(rule.gradients + q * nodes_, nodes_, gradients_.begin() + static_cast<ptrdiff_t>(q * all));
    std::copy_n(rule.mode_gradients + q * modes_, modes_,
                gradients_.begin() + static_cast<ptrdiff_t>(q * all + nodes_));
  }
  std::copy_n(x, nodes_, x_.begin());
  std::fill(x_.begin() + static_cast<ptrdiff_t>(nodes_), x_.end(), Vec3{});
  rule_.nodes = all, rule_.gradients = gradients_.data(), rule_.modes = 0, rule_.mode_gradients = nullptr;

  constexpr int kMost = 30;
  // Relative to the terms that cancel in a residual: some roundings of sums of eight points.
  constexpr double kAccurate = 1e-14;
  for (int it = 0; it < kMost; ++it) {
    std::array<double, kOwn> r;
    double size = 0, norm = 0;
    const double energy = residual(material, r, size);
    for (size_t k = 0; k < 3 * modes_; ++k) norm = std::max(norm, std::abs(r[k]));
    if (!(norm > kAccurate * size)) return;
    if (!improve(material, Definite::no, r, energy) && !improve(material, Definite::yes, r, energy)) return;
    if (material.law == Law::linear) return;
  }
}

double RelaxedCell::residual(const Material& material, std::array<double, kOwn>& r, double& size) const {
  std::array<Vec3, kAll> f{};
  const double energy = cell_forces(material, rule_, x_.data(), f.data());
  for (size_t k = 0; k < modes_; ++k) {
    const Vec3 g = f[nodes_ + k];
    r[3 * k] = -g.x, r[3 * k + 1] = -g.y, r[3 * k + 2] = -g.z;
  }
  // Moduli times gradients times volume: the size of the forces at a strain of 1.
  double steep = 0, volume = 0;
  for (size_t q = 0; q < rule_.points; ++q) {
    volume += rule_.weights[q];
    for (size_t k = 0; k < modes_; ++k)
      steep = std::max(steep, norm(gradients_[q * rule_.nodes + nodes_ + k]));
  }
  size = (2 * material.mu + std::abs(material.lambda)) * steep * volume;
  return energy;
}

// Moves alpha by a step that lowers the energy; false if there is none.
bool RelaxedCell::improve(const Material& material, Definite definite, const std::array<double, kOwn>& r,
                          double energy) {
  const size_t all = nodes_ + modes_, own = 3 * modes_;
  std::array<double, 9 * kAll * kAll> k;
  cell_stiffness(material, rule_, x_.data(), definite, k.data());
  std::array<double, kOwn * kOwn> a;
  for (size_t i = 0; i < own; ++i) {
    for (size_t j = 0; j < own; ++j) a[i * own + j] = entry(k.data(), all, 3 * nodes_ + i, 3 * nodes_ + j);
  }
  if (!factorise(a.data(), own)) return false;
  std::array<double, kOwn> d = r;
  solve(a.data(), own, d.data());
  double slope = 0;
  for (size_t i = 0; i < own; ++i) slope -= r[i] * d[i];
  const std::array<Vec3, kAll> from = x_;
  // Energies within rounding count as equal.
  const double noise = 1e-14 * std::abs(energy);
  for (double share = 1; share > 1e-6; share *= 0.5) {
    for (size_t m = 0; m < modes_; ++m)
      x_[nodes_ + m] = from[nodes_ + m] - share * Vec3{d[3 * m], d[3 * m + 1], d[3 * m + 2]};
    if (cell_forces(material, rule_, x_.data(), nullptr) <= energy + 1e-4 * share * slope + noise)
      return true;
  }
  x_ = from;
  return false;
}

double RelaxedCell::forces(const Material& material, Vec3* forces) const {
  if (!forces) return cell_forces(material, rule_, x_.data(), nullptr);
  std::array<Vec3, kAll> f{};
  const double energy = cell_forces(material, rule_, x_.data(), f.data());
  for (size_t a = 0; a < nodes_; ++a) forces[a] += f[a];
  return energy;
}

// K_xx - K_xa K_aa^-1 K_ax. If K_aa is not definite the modes are kept fixed.
void RelaxedCell::stiffness(const Material& material, Definite definite, double* out) const {
  const size_t all = nodes_ + modes_, own = 3 * modes_, outer = 3 * nodes_;
  std::array<double, 9 * kAll * kAll> k;
  cell_stiffness(material, rule_, x_.data(), definite, k.data());
  std::array<double, kOwn * kOwn> a;
  for (size_t i = 0; i < own; ++i) {
    for (size_t j = 0; j < own; ++j) a[i * own + j] = entry(k.data(), all, outer + i, outer + j);
  }
  const bool condensed = factorise(a.data(), own);
  for (size_t b = 0; b < nodes_; ++b) {
    for (size_t c = 0; c < 3; ++c) {
      std::array<double, kOwn> column;
      for (size_t i = 0; i < own; ++i) column[i] = entry(k.data(), all, outer + i, 3 * b + c);
      if (condensed) solve(a.data(), own, column.data());
      for (size_t row = 0; row < outer; ++row) {
        double value = entry(k.data(), all, row, 3 * b + c);
        for (size_t i = 0; i < own && condensed; ++i)
          value -= entry(k.data(), all, row, outer + i) * column[i];
        out[9 * (row / 3 * nodes_ + b) + 3 * c + row % 3] = value;
      }
    }
  }
}

}  // namespace truestep::fem
