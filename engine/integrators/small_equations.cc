#include "engine/integrators/small_equations.h"

namespace truestep::detail {

namespace {

// Adds the values of a matrix of size m to the Jacobian of n equations, its first element at (row, column).
void expand(const MatrixShape& shape, const double* values, size_t m, size_t row, size_t column, size_t n,
            double* jacobian) {
  const auto put = [&](size_t i, size_t j, double v) { jacobian[(column + j) * n + row + i] = v; };
  if (shape.kind == MatrixShape::Kind::dense) {
    for (size_t j = 0; j < m; ++j) {
      for (size_t i = 0; i < m; ++i) put(i, j, values[j * m + i]);
    }
  } else if (shape.kind == MatrixShape::Kind::banded) {
    const size_t width = shape.lower + shape.upper + 1;
    for (size_t j = 0; j < m; ++j) {
      for (size_t i = 0; i < m; ++i) {
        if (i <= j + shape.lower && j <= i + shape.upper) put(i, j, values[j * width + shape.upper + i - j]);
      }
    }
  } else {
    for (size_t j = 0; j < m; ++j) {
      for (int32_t k = shape.column_start[j]; k < shape.column_start[j + 1]; ++k) {
        put(size_t(shape.rows[size_t(k)]), j, values[k]);
      }
    }
  }
}

}  // namespace

void small_jacobian(Equations& eq, double t, const double* y, const double* fy, double* jacobian) {
  ++eq.count().jacobians;
  const RightHandSide& f = eq.f();
  const size_t n = eq.size(), half = n / 2;
  // Any shape with at most n columns: a band may be wider than the matrix.
  const size_t room = 3 * n * n;
  constexpr size_t kRoom = 3 * kSmallest * kSmallest;
  const SecondOrder* second = f.second_order();
  if (!second && f.has_jacobian()) {
    const MatrixShape shape = f.jacobian_shape();
    if (shape.kind == MatrixShape::Kind::dense) return f.jacobian(t, y, jacobian);
    if (shape.values(n) <= room) {
      std::array<double, kRoom> values;
      f.jacobian(t, y, values.data());
      std::fill_n(jacobian, n * n, 0.0);
      return expand(shape, values.data(), n, 0, 0, n, jacobian);
    }
  }
  if (second && second->has_jacobian() && second->shape().values(half) <= room) {
    std::array<double, kRoom> dadx, dadv;
    second->jacobian(t, y, y + half, dadx.data(), dadv.data());
    std::fill_n(jacobian, n * n, 0.0);
    for (size_t i = 0; i < half; ++i) jacobian[(half + i) * n + i] = 1;
    expand(second->shape(), dadx.data(), half, half, 0, n, jacobian);
    return expand(second->shape(), dadv.data(), half, half, half, n, jacobian);
  }
  const double typical = typical_size(eq.advance().tolerance);
  std::array<double, kSmallest> moved, rate;
  std::copy_n(y, n, moved.begin());
  for (size_t j = 0; j < n; ++j) {
    moved[j] = y[j] + 0x1p-26 * std::max(std::abs(y[j]), typical);
    eq.rate(t, moved.data(), rate.data());
    const double inverse = 1 / (moved[j] - y[j]);
    for (size_t i = 0; i < n; ++i) jacobian[j * n + i] = (rate[i] - fy[i]) * inverse;
    moved[j] = y[j];
  }
}

}  // namespace truestep::detail

namespace truestep {

template class SmallEquations<1>;
template class SmallEquations<2>;
template class SmallEquations<3>;
template class SmallEquations<4>;
template class SmallEquations<5>;
template class SmallEquations<6>;
template class SmallEquations<7>;
template class SmallEquations<8>;

}  // namespace truestep
