#include "engine/math/solvers/dense_symmetric.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace truestep {

namespace {

using Matrix = Eigen::MatrixXd;

auto view(const DenseColumns& a) {
  return Eigen::Map<const Matrix>(a.numbers.data(), static_cast<Eigen::Index>(a.rows),
                                  static_cast<Eigen::Index>(a.columns));
}

DenseEigen result(const Eigen::VectorXd& values, const Matrix& vectors) {
  const auto n = static_cast<size_t>(values.size());
  DenseEigen out{{values.data(), values.data() + n}, {n, n}};
  std::copy_n(vectors.data(), n * n, out.vectors.numbers.data());
  return out;
}

}  // namespace

DenseColumns DenseColumns::transposed() const {
  DenseColumns out(columns, rows);
  for (size_t c = 0; c < columns; ++c) {
    for (size_t r = 0; r < rows; ++r) out(c, r) = (*this)(r, c);
  }
  return out;
}

DenseColumns operator*(const DenseColumns& a, const DenseColumns& b) {
  const Matrix all = view(a) * view(b);
  DenseColumns out(a.rows, b.columns);
  std::copy_n(all.data(), out.numbers.size(), out.numbers.data());
  return out;
}

DenseEigen symmetric_eigen(const DenseColumns& a) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(view(a));
  return result(eigen.eigenvalues(), eigen.eigenvectors());
}

DenseEigen generalized_eigen(const DenseColumns& a, const DenseColumns& b) {
  // With b = L L^T and y = L^T x: L^-1 a L^-T y = value y.
  const size_t n = a.rows;
  DenseColumns lower(n, n);
  for (size_t c = 0; c < n; ++c) {
    for (size_t r = c; r < n; ++r) {
      double left = b(r, c);
      for (size_t k = 0; k < c; ++k) left -= lower(r, k) * lower(c, k);
      lower(r, c) = r == c ? std::sqrt(left) : left / lower(c, c);
    }
  }
  const auto divide = [&](DenseColumns& of) {
    for (size_t c = 0; c < n; ++c) {
      for (size_t r = 0; r < n; ++r) {
        for (size_t k = 0; k < r; ++k) of(r, c) -= lower(r, k) * of(k, c);
        of(r, c) /= lower(r, r);
      }
    }
  };
  DenseColumns once = a;
  divide(once);
  DenseColumns reduced = once.transposed();
  divide(reduced);
  DenseEigen out = symmetric_eigen(reduced);
  for (size_t c = 0; c < n; ++c) {
    for (size_t r = n; r-- > 0;) {
      double left = out.vectors(r, c);
      for (size_t k = r + 1; k < n; ++k) left -= lower(k, r) * out.vectors(k, c);
      out.vectors(r, c) = left / lower(r, r);
    }
  }
  return out;
}

PrincipalComponents principal_components(DenseColumns& samples) {
  Eigen::Map<Matrix> all(samples.numbers.data(), static_cast<Eigen::Index>(samples.rows),
                         static_cast<Eigen::Index>(samples.columns));
  const Eigen::VectorXd mean = all.rowwise().mean();
  all.colwise() -= mean;
  const double count = static_cast<double>(std::max<size_t>(samples.columns - 1, 1));
  DenseColumns covariance = samples * samples.transposed();
  double trace = 0;
  for (double& x : covariance.numbers) x /= count;
  for (size_t k = 0; k < samples.rows; ++k) trace += covariance(k, k);
  return {symmetric_eigen(covariance), trace};
}

}  // namespace truestep
