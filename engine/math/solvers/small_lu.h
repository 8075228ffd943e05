// P A = L U of an N x N matrix with N known at compile time (N <= 8 or so): partial pivoting, loops unrolled,
// everything in a few registers or one cache line. Column by column; T is double or Complex. Golub, Van Loan
// 2013, algorithm 3.4.1.
#pragma once
#include <array>
#include <cstddef>

#include "engine/math/complex.h"

namespace truestep {

template <class T, int N>
class SmallLu {
 public:
  /// Where to put the matrix before `factor`: element (i, j) at j * N + i. It is overwritten.
  T* matrix() { return a_.data(); }

  /// False: the matrix is singular or not finite.
  bool factor() {
    bool regular = true;
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) {
      int p = k;
      double best = magnitude(at(k, k));
#pragma GCC unroll 8
      for (int i = k + 1; i < N; ++i) {
        const double m = magnitude(at(i, k));
        if (m > best) best = m, p = i;
      }
      pivot_[k] = p;
      regular = regular && best > 0 && best < kHuge;
      if (p != k) {
#pragma GCC unroll 8
        for (int j = 0; j < N; ++j) {
          const T t = at(k, j);
          at(k, j) = at(p, j), at(p, j) = t;
        }
      }
      inverse_[k] = reciprocal(at(k, k));
#pragma GCC unroll 8
      for (int i = k + 1; i < N; ++i) at(i, k) *= inverse_[k];
#pragma GCC unroll 8
      for (int j = k + 1; j < N; ++j) {
        const T u = at(k, j);
#pragma GCC unroll 8
        for (int i = k + 1; i < N; ++i) at(i, j) -= at(i, k) * u;
      }
    }
    return regular;
  }

  /// b = A^-1 b.
  void solve(T* b) const {
    T x[N];
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i) x[i] = b[i];
#pragma GCC unroll 8
    for (int k = 0; k < N - 1; ++k) {
      const int p = pivot_[k];
      const T t = x[p];
      x[p] = x[k], x[k] = t;
    }
#pragma GCC unroll 8
    for (int k = 0; k < N - 1; ++k) {
#pragma GCC unroll 8
      for (int i = k + 1; i < N; ++i) x[i] -= at(i, k) * x[k];
    }
#pragma GCC unroll 8
    for (int k = N - 1; k >= 0; --k) {
      x[k] *= inverse_[k];
#pragma GCC unroll 8
      for (int i = 0; i < k; ++i) x[i] -= at(i, k) * x[k];
    }
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i) b[i] = x[i];
  }

 private:
  static constexpr double kHuge = 1e300;
  T& at(int i, int j) {
    return a_[static_cast<size_t>(j) * N + static_cast<size_t>(i)];
  }
  const T& at(int i, int j) const {
    return a_[static_cast<size_t>(j) * N + static_cast<size_t>(i)];
  }

  std::array<T, static_cast<size_t>(N* N)> a_;
  std::array<T, N> inverse_;
  std::array<int, N> pivot_;
};

}  // namespace truestep
