// Sparse LU by Eigen, and the choice between the libraries.
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <vector>

#include "engine/base/errors.h"
#include "engine/integrators/linear/sparse_lu.h"

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

SparseLibrary preferred_sparse_library() {
#ifdef TRUESTEP_KLU
  return SparseLibrary::klu;
#else
  return SparseLibrary::eigen;
#endif
}

template <class T>
std::unique_ptr<SparseLu<T>> make_sparse_lu(SparseLibrary library) {
  if (library == SparseLibrary::eigen) return make_eigen_lu<T>();
#ifdef TRUESTEP_KLU
  return make_klu<T>();
#else
  throw Error("not_built", "this program was built without KLU");
#endif
}
template std::unique_ptr<SparseLu<double>> make_sparse_lu(SparseLibrary);
template std::unique_ptr<SparseLu<std::complex<double>>> make_sparse_lu(SparseLibrary);

}  // namespace truestep
