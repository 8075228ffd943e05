// Sparse LU by Eigen, part of the engine where the build says TRUESTEP_SPARSE=eigen.
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <vector>

#include "engine/math/solvers/sparse/sparse_lu.h"

namespace truestep {

namespace {

template <class T>
class EigenLu final : public SparseLu<T> {
 public:
  void analyse(int n, const int* column_start, const int* rows) override {
    const std::vector<T> zeros(static_cast<size_t>(column_start[n]), T(0));
    matrix_ =
        Eigen::Map<const Eigen::SparseMatrix<T>>(n, n, column_start[n], column_start, rows, zeros.data());
    lu_.analyzePattern(matrix_);
  }
  bool factor(const T* values) override {
    std::copy_n(values, matrix_.nonZeros(), matrix_.valuePtr());
    lu_.factorize(matrix_);
    return lu_.info() == Eigen::Success;
  }
  void solve(T* b) override {
    Eigen::Map<Eigen::Matrix<T, Eigen::Dynamic, 1>> x(b, matrix_.rows());
    x = lu_.solve(x).eval();
  }

 private:
  Eigen::SparseMatrix<T> matrix_;
  Eigen::SparseLU<Eigen::SparseMatrix<T>> lu_;
};

}  // namespace

template <class T>
std::unique_ptr<SparseLu<T>> make_eigen_lu() {
  return std::make_unique<EigenLu<T>>();
}

template std::unique_ptr<SparseLu<double>> make_eigen_lu();
template std::unique_ptr<SparseLu<std::complex<double>>> make_eigen_lu();

}  // namespace truestep
