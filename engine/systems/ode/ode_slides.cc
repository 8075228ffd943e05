#include "engine/systems/ode/ode_slides.h"

#include <algorithm>
#include <cmath>

namespace truestep::ode {

bool OdeSlides::any() const {
  return std::ranges::any_of(sliding_, [](int32_t s) { return s != 0; });
}

void OdeSlides::evaluate(double t, const double* y) {
  all_.assign(parameters_.begin(), parameters_.end());
  for (size_t k = 0; k < count(); ++k) {
    if (sliding(k)) all_[first() + k] = 0;
  }
  values_.set_parameters(all_);
  values_(t, y, model_.size(), model_.parameter_values.size(), out_.data());
}

// Gauss with pivots; a row that holds nothing keeps s = 0.
std::span<const double> OdeSlides::sides(double t, const double* y) {
  for (size_t k = 0; k < count(); ++k) sides_[k] = parameters_[first() + k];
  if (!any()) return sides_;
  evaluate(t, y);
  rows_.clear();
  for (size_t k = 0; k < count(); ++k) {
    if (sliding(k)) rows_.push_back(k);
  }
  const size_t n = rows_.size(), width = n + 1;
  matrix_.resize(n * width);
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j < n; ++j) matrix_[i * width + j] = at(rows_[i], 2 + rows_[j]);
    matrix_[i * width + n] = -at(rows_[i], 1);
  }
  for (size_t i = 0; i < n; ++i) {
    size_t pivot = i;
    for (size_t r = i + 1; r < n; ++r) {
      if (std::abs(matrix_[r * width + i]) > std::abs(matrix_[pivot * width + i])) pivot = r;
    }
    for (size_t c = 0; pivot != i && c < width; ++c)
      std::swap(matrix_[i * width + c], matrix_[pivot * width + c]);
    const double p = matrix_[i * width + i];
    for (size_t r = 0; p != 0 && r < n; ++r) {
      if (r == i) continue;
      const double f = matrix_[r * width + i] / p;
      for (size_t c = i; c < width; ++c) matrix_[r * width + c] -= f * matrix_[i * width + c];
    }
  }
  for (size_t i = 0; i < n; ++i) {
    const double p = matrix_[i * width + i];
    sides_[rows_[i]] = p != 0 ? matrix_[i * width + n] / p : 0;
  }
  return sides_;
}

bool OdeSlides::holds(size_t k, double t, const double* y, double& value) {
  const int32_t before = sliding_[k];
  sliding_[k] = 1;
  value = sides(t, y)[k];
  const bool back = at(k, 2 + k) < 0 && std::abs(value) < 1;
  sliding_[k] = before;
  return back;
}

double OdeSlides::clear_of_zero(size_t k, const double* y, double g) const {
  constexpr double kRounding = 1e-15;
  double most = 0;
  for (size_t i = 0; i < model_.size(); ++i) most = std::max(most, std::abs(y[i]));
  const double noise = kRounding * most;
  return std::abs(g) <= noise ? parameters_[first() + k] * noise : g;
}

int32_t OdeSlides::turn(size_t k, double t, const double* y) {
  double& side = parameters_[first() + k];
  double value = 0;
  if (sliding(k)) {
    side = sides(t, y)[k] < 0 ? -1 : 1;
    sliding_[k] = 0;
    return side < 0 ? -1 : 1;
  }
  if (holds(k, t, y, value)) {
    sliding_[k] = 1;
    return 1;
  }
  // What moves away from zero only seems to cross it, because of rounding.
  if (!(side * (at(k, 1) + at(k, 2 + k) * side) > 0)) side = -side;
  return side < 0 ? -1 : 1;
}

bool OdeSlides::refresh(double t, const double* y, double near) {
  bool changed = false;
  for (size_t k = 0; k < count(); ++k) {
    evaluate(t, y);
    const double g = at(k, 0);
    double& side = parameters_[first() + k];
    double value = 0;
    if (sliding(k) && std::abs(g) <= near) {
      value = sides(t, y)[k];
      if (std::abs(value) <= 1) continue;
      sliding_[k] = 0, side = value < 0 ? -1 : 1;
    } else if (g == 0) {
      if (holds(k, t, y, value)) {
        sliding_[k] = 1;
      } else {
        // It leaves to where its rate leads.
        const double to = at(k, 1) < 0 ? -1 : 1;
        if (!sliding(k) && side == to) continue;
        sliding_[k] = 0, side = to;
      }
    } else {
      const double now = g < 0 ? -1 : 1;
      if (!sliding(k) && (side == now || std::abs(g) <= near)) continue;
      sliding_[k] = 0, side = now;
    }
    changed = true;
  }
  return changed;
}

}  // namespace truestep::ode
