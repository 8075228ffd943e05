#include "engine/integrators/equations.h"

namespace truestep {

// Adds the values of a matrix of size m to the Jacobian, its first element at (row, column).
template <int N>
void SmallEquations<N>::expand(const MatrixShape& shape, const double* values, size_t m, size_t row,
                               size_t column) {
  const auto put = [&](size_t i, size_t j, double v) { jacobian_[(column + j) * N + row + i] = v; };
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

template <int N>
void SmallEquations<N>::differentiate(double t, const double* y, const double* fy) {
  ++this->count_.jacobians;
  const RightHandSide& f = this->a_.f;
  // Any shape with at most N columns: a band may be wider than the matrix.
  constexpr size_t kRoom = size_t(3 * N * N);
  const SecondOrder* second = f.second_order();
  if (!second && f.has_jacobian()) {
    const MatrixShape shape = f.jacobian_shape();
    if (shape.kind == MatrixShape::Kind::dense) return f.jacobian(t, y, jacobian_.data());
    if (shape.values(N) <= kRoom) {
      std::array<double, kRoom> values;
      f.jacobian(t, y, values.data());
      jacobian_.fill(0);
      return expand(shape, values.data(), N, 0, 0);
    }
  }
  if (second && second->has_jacobian() && second->shape().values(N / 2) <= kRoom) {
    constexpr size_t kHalf = N / 2;
    std::array<double, kRoom> dadx, dadv;
    second->jacobian(t, y, y + kHalf, dadx.data(), dadv.data());
    jacobian_.fill(0);
    for (size_t i = 0; i < kHalf; ++i) jacobian_[(kHalf + i) * N + i] = 1;
    expand(second->shape(), dadx.data(), kHalf, kHalf, 0);
    return expand(second->shape(), dadv.data(), kHalf, kHalf, kHalf);
  }
  const double typical = typical_size(this->a_.tolerance);
  std::array<double, N> moved, rate;
  std::copy_n(y, N, moved.begin());
  for (size_t j = 0; j < N; ++j) {
    moved[j] = y[j] + 0x1p-26 * std::max(std::abs(y[j]), typical);
    this->rate(t, moved.data(), rate.data());
    const double inverse = 1 / (moved[j] - y[j]);
    for (size_t i = 0; i < N; ++i) jacobian_[j * N + i] = (rate[i] - fy[i]) * inverse;
    moved[j] = y[j];
  }
}

template class SmallEquations<1>;
template class SmallEquations<2>;
template class SmallEquations<3>;
template class SmallEquations<4>;
template class SmallEquations<5>;
template class SmallEquations<6>;
template class SmallEquations<7>;
template class SmallEquations<8>;

namespace {
template <size_t K>
void combine_terms(size_t n, double* out, const double* y, const double* c, const double* k, size_t stride) {
#pragma GCC ivdep
  for (size_t i = 0; i < n; ++i) {
    double sum = y ? y[i] : 0;
#pragma GCC unroll 8
    for (size_t j = 0; j < K; ++j) sum += c[j] * k[j * stride + i];
    out[i] = sum;
  }
}
}  // namespace

void combine_large(size_t n, double* out, const double* y, const double* c, const double* k, size_t stride,
                   size_t count) {
  using Kernel = void (*)(size_t, double*, const double*, const double*, const double*, size_t);
  static constexpr Kernel kKernels[] = {combine_terms<0>, combine_terms<1>, combine_terms<2>,
                                        combine_terms<3>, combine_terms<4>, combine_terms<5>,
                                        combine_terms<6>, combine_terms<7>, combine_terms<8>};
  kKernels[count](n, out, y, c, k, stride);
}

}  // namespace truestep
