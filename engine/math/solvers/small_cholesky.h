// Solution of a x = y by Cholesky factorization, for small symmetric positive definite matrices.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace truestep {

/// a: n x n, of which the lower half is read and becomes the factor; y becomes x. A pivot that is not
/// positive is replaced by a tiny one.
inline void cholesky_solve(double* a, double* y, size_t n) {
  for (size_t r = 0; r < n; ++r) {
    for (size_t c = 0; c <= r; ++c) {
      double s = a[r * n + c];
      for (size_t k = 0; k < c; ++k) s -= a[r * n + k] * a[c * n + k];
      a[r * n + c] = r == c ? std::sqrt(std::max(s, 1e-300)) : s / a[c * n + c];
    }
  }
  for (size_t r = 0; r < n; ++r) {
    for (size_t k = 0; k < r; ++k) y[r] -= a[r * n + k] * y[k];
    y[r] /= a[r * n + r];
  }
  for (size_t r = n; r-- > 0;) {
    for (size_t k = r + 1; k < n; ++k) y[r] -= a[k * n + r] * y[k];
    y[r] /= a[r * n + r];
  }
}

}  // namespace truestep
