#include "engine/integrators/linear/symmetric_factors.h"

#include <algorithm>
#include <cmath>

namespace truestep {

namespace {
// Relative error of a known solution up to which factors without pivots are used; Newton's method contracts
// at least by this factor.
constexpr double kAccepted = 1e-8;
}  // namespace

SymmetricFactors::SymmetricFactors(size_t n, std::span<const int32_t> column_start,
                                   std::span<const int32_t> rows) {
  std::vector<BlockSparse::Pair> pairs;
  for (size_t j = 0; j < n; j += 3) {
    for (int32_t k = column_start[j]; k < column_start[j + 1]; k += 3) {
      pairs.push_back(
          {static_cast<uint32_t>(rows[static_cast<size_t>(k)] / 3), static_cast<uint32_t>(j / 3)});
    }
  }
  matrix_.set_pattern(n / 3, 3, pairs);
  for (size_t j = 0; j < n; ++j) {
    for (int32_t k = column_start[j]; k < column_start[j + 1]; ++k) {
      const auto i = static_cast<size_t>(rows[static_cast<size_t>(k)]);
      place_.push_back(static_cast<uint32_t>(9 * matrix_.slot(i / 3, j / 3) + 3 * (j % 3) + i % 3));
      rows_.push_back(static_cast<int32_t>(i)), column_of_.push_back(static_cast<int32_t>(j));
    }
  }
  mass_.resize(n / 3), known_.resize(2 * n);
  ldlt_.analyze(matrix_);
}

bool SymmetricFactors::factor(const double* a1, const double* a2, double c1, double c2,
                              std::span<const double> inverse_mass) {
  for (size_t i = 0; i < mass_.size(); ++i) mass_[i] = inverse_mass[i] > 0 ? 1 / inverse_mass[i] : 0;
  matrix_.set_zero();
  double* values = matrix_.values().data();
  held_.clear();
  for (size_t k = 0; k < place_.size(); ++k) {
    const auto i = static_cast<uint32_t>(rows_[k]), j = static_cast<uint32_t>(column_of_[k]);
    const double mass = mass_[i / 3];
    if (mass == 0) continue;
    const double value = a2 ? a1[k] * c1 + a2[k] * c2 : a1[k] * c1;
    if (mass_[j / 3] == 0) {
      if (value != 0) held_.push_back({i, j, -value});
    } else {
      values[place_[k]] -= mass * value;
    }
  }
  for (size_t i = 0; i < mass_.size(); ++i) {
    double* diagonal = values + 9 * size_t{matrix_.diagonal_slot(i)};
    for (size_t c = 0; c < 3; ++c) diagonal[4 * c] += mass_[i] == 0 ? 1 : mass_[i];
  }
  const auto outcome = ldlt_.factorize(matrix_);
  if (outcome == BlockLdlt::Outcome::singular) return false;
  return outcome == BlockLdlt::Outcome::positive_definite || returns_known_solution();
}

bool SymmetricFactors::returns_known_solution() {
  const size_t n = 3 * mass_.size();
  double *x = known_.data(), *y = x + n;
  for (size_t k = 0; k < n; ++k) x[k] = 1 + 0.125 * double(k % 7), y[k] = 0;
  const double* values = matrix_.values().data();
  for (size_t i = 0; i < mass_.size(); ++i) {
    for (auto s = matrix_.row_begin(i); s < matrix_.row_begin(i + 1); ++s) {
      const double* block = values + 9 * size_t{s};
      const double* from = x + 3 * size_t{matrix_.column(s)};
      for (size_t c = 0; c < 3; ++c) {
        for (size_t r = 0; r < 3; ++r) y[3 * i + r] += block[3 * c + r] * from[c];
      }
    }
  }
  ldlt_.solve({y, n}, {y, n});
  // Also false for a NaN.
  for (size_t k = 0; k < n; ++k) {
    if (!(std::abs(y[k] - x[k]) <= kAccepted)) return false;
  }
  return true;
}

void SymmetricFactors::solve(double* b) {
  const size_t n = 3 * mass_.size();
  for (const Held& h : held_) b[h.row] -= h.value * b[h.column];
  for (size_t k = 0; k < n; ++k) {
    if (mass_[k / 3] > 0) b[k] *= mass_[k / 3];
  }
  ldlt_.solve({b, n}, {b, n});
}

}  // namespace truestep
