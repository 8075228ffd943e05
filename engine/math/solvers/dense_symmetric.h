// Eigenvalues of small dense symmetric matrices and the products that lead to them, by Eigen, whose templates
// are compiled here once. Matrices are by columns. Done when something is built, never in a step.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace truestep {

struct DenseColumns {
  DenseColumns(size_t rows, size_t columns) : rows(rows), columns(columns), numbers(rows * columns) {}
  size_t rows, columns;
  std::vector<double> numbers;

  double& operator()(size_t r, size_t c) { return numbers[c * rows + r]; }
  double operator()(size_t r, size_t c) const { return numbers[c * rows + r]; }
  std::span<double> column(size_t c) { return std::span(numbers).subspan(c * rows, rows); }
  DenseColumns transposed() const;
};

/// a b.
DenseColumns operator*(const DenseColumns& a, const DenseColumns& b);

/// Eigenvalues in ascending order, and their vectors as columns.
struct DenseEigen {
  std::vector<double> values;
  DenseColumns vectors;
};
/// Of a symmetric matrix.
DenseEigen symmetric_eigen(const DenseColumns& a);
/// Of a x = value b x; both symmetric, b positive definite.
DenseEigen generalized_eigen(const DenseColumns& a, const DenseColumns& b);

/// The principal axes of samples, which are columns; takes their mean away from them.
struct PrincipalComponents {
  DenseEigen of_covariance;
  double trace = 0;  ///< of the covariance
};
PrincipalComponents principal_components(DenseColumns& samples);

}  // namespace truestep
