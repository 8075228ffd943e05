// P A = L U of a band matrix with `lower` diagonals below and `upper` above the main one, partial pivoting (U
// then has lower + upper diagonals). Golub, Van Loan 2013, section 4.3.5. T is double or Complex. Tridiagonal
// matrices that need no exchange are solved by two recurrences with one fused multiply-add per row.
#pragma once
#include <cstddef>
#include <vector>

#include "engine/math/complex.h"

namespace truestep {

template <class T>
class BandLu {
 public:
  void resize(size_t n, size_t lower, size_t upper);
  /// Start of column j's part of the band: element (i, j) is at column(j)[upper + i - j], for rows i inside
  /// the matrix and the band. Write all of them before `factor`, which overwrites them.
  T* column(size_t j) { return a_.data() + j * height_ + lower_; }
  /// False: the matrix is singular or not finite.
  bool factor();
  /// b = A^-1 b.
  void solve(T* b) const;

 private:
  bool factor_tridiagonal();
  bool factor_general();

  size_t n_ = 0, lower_ = 0, upper_ = 0, height_ = 0;
  bool recurrences_ = false;  // the last factorisation was tridiagonal without exchanges
  std::vector<T> a_, inverse_, below_, above_;
  std::vector<size_t> pivot_;
};

}  // namespace truestep
