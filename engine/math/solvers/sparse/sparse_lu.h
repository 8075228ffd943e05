// Sparse LU of square matrices that share one pattern. One library factorises in all of a program: KLU
// (Davis, Palamadai Natarajan 2010, "Algorithm 907": block triangular form, then left-looking columns without
// supernodes, made for circuits), or Eigen's SparseLU (supernodal, Demmel et al. 1999) where the build says
// TRUESTEP_SPARSE=eigen: results differ in their last bits, so that what happens to be installed must not
// decide. KLU is 2.2 to 2.5 times as fast as Eigen on a chain of 1,000 masses, 1.05 to 1.1 times on a grid of
// 64 x 64 points (tests/bench/sparse_lu.cc). The ordering is computed once per pattern; pivots are chosen
// anew for every matrix, never reused from an older one, so that a restored run repeats every bit. Both
// allocate at every factorisation, the one exception to "no allocation per step".
#pragma once
#include <complex>
#include <cstdint>
#include <memory>

namespace truestep {

template <class T>  // double or std::complex<double>
class SparseLu {
 public:
  virtual ~SparseLu() = default;
  /// Compressed columns, rows ascending; must come first.
  virtual void analyse(int n, const int* column_start, const int* rows) = 0;
  /// The values in the pattern's order. False: singular.
  virtual bool factor(const T* values) = 0;
  /// x = A^-1 b in place.
  virtual void solve(T* b) = 0;
};

/// By the program's library.
template <class T>
std::unique_ptr<SparseLu<T>> make_sparse_lu();
extern template std::unique_ptr<SparseLu<double>> make_sparse_lu();
extern template std::unique_ptr<SparseLu<std::complex<double>>> make_sparse_lu();

/// By either; only one of them is part of the engine (sparse_lu_klu.cc, sparse_lu_eigen.cc).
template <class T>
std::unique_ptr<SparseLu<T>> make_klu_lu();
template <class T>
std::unique_ptr<SparseLu<T>> make_eigen_lu();

}  // namespace truestep
