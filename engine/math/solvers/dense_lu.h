// P A = L U of a dense matrix of any size, partial pivoting: columns in panels of four, so that the rest of
// the matrix is read and written once per four eliminated columns and its loops vectorise over rows.
// Golub, Van Loan 2013, section 3.4. T is double or Complex. Meant for a few hundred unknowns.
#pragma once
#include <cstddef>
#include <vector>

#include "engine/math/complex.h"

namespace truestep {

template <class T>
class DenseLu {
 public:
  void resize(size_t n);
  /// Where to put the matrix before `factor`: element (i, j) at j * n + i. It is overwritten.
  T* matrix() { return a_.data(); }
  /// False: the matrix is singular or not finite.
  bool factor();
  /// b = A^-1 b.
  void solve(T* b) const;

 private:
  bool factor_panel(size_t first, size_t width);
  void update_columns(size_t first, size_t width);

  size_t n_ = 0;
  std::vector<T> a_, inverse_;
  std::vector<size_t> pivot_;
};

}  // namespace truestep
