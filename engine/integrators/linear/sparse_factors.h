// Sparse factors of M = I - c1 A1 - c2 A2 for two matrices of one pattern, real or complex: LU, or L D L^T
// where inverse masses make M symmetric and it needs no pivots. The fill-reducing order is found once per
// pattern; see math/solvers/sparse/sparse_lu.h and symmetric_factors.h.
#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "engine/math/complex.h"

namespace truestep {

class SparseFactors {
 public:
  /// Compressed columns of A1 and A2; the diagonal is added where it is missing.
  SparseFactors(size_t n, std::span<const int32_t> column_start, std::span<const int32_t> rows);
  ~SparseFactors();

  /// False: singular. `a2` may be null.
  /// `inverse_mass` as in SecondOrder::symmetric_in.
  bool factor(const double* a1, const double* a2, double c1, double c2,
              std::span<const double> inverse_mass = {});
  bool factor(const double* a1, const double* a2, Complex c1, Complex c2);
  void solve(double* b);
  void solve(Complex* b);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace truestep
