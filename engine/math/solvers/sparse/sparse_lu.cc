#include "engine/math/solvers/sparse/sparse_lu.h"

namespace truestep {

// TRUESTEP_SPARSE_LU: make_klu_lu or make_eigen_lu, from the build's option TRUESTEP_SPARSE.
template <class T>
std::unique_ptr<SparseLu<T>> make_sparse_lu() {
  return TRUESTEP_SPARSE_LU<T>();
}
template std::unique_ptr<SparseLu<double>> make_sparse_lu();
template std::unique_ptr<SparseLu<std::complex<double>>> make_sparse_lu();

}  // namespace truestep
