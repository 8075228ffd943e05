#include "engine/math/solvers/band_lu.h"

#include <algorithm>
#include <cmath>

#include "engine/base/interrupt.h"

namespace truestep {

namespace {
constexpr double kHugePivot = 1e300;

// a - b c
double subtract_product(double a, double b, double c) {
  return std::fma(-b, c, a);
}
Complex subtract_product(Complex a, Complex b, Complex c) {
  return {std::fma(-b.re, c.re, std::fma(b.im, c.im, a.re)),
          std::fma(-b.re, c.im, std::fma(-b.im, c.re, a.im))};
}
}  // namespace

template <class T>
void BandLu<T>::resize(size_t n, size_t lower, size_t upper) {
  n_ = n, lower_ = std::min(lower, n - 1), upper_ = std::min(upper, n - 1);
  height_ = 2 * lower_ + upper_ + 1;
  a_.assign(n * height_, T(0));
  inverse_.resize(n);
  pivot_.resize(n);
  if (lower_ == 1 && upper_ == 1) {
    below_.resize(n);
    above_.resize(n);
  }
}

template <class T>
bool BandLu<T>::factor() {
  recurrences_ = lower_ == 1 && upper_ == 1 && factor_tridiagonal();
  return recurrences_ || factor_general();
}

// Keeps the matrix and gives up as soon as rows would have to be exchanged.
template <class T>
bool BandLu<T>::factor_tridiagonal() {
  // Column j holds, from the top: fill, (j - 1, j), (j, j), (j + 1, j).
  T diagonal = a_[2];
  for (size_t k = 0;; ++k) {
    const T* c = a_.data() + 4 * k;
    const double size = magnitude(diagonal);
    if (!(size > 0 && size < kHugePivot)) return false;
    const T inverse = inverse_[k] = reciprocal(diagonal);
    if (k + 1 == n_) return true;
    if (magnitude(c[3]) > size) return false;
    below_[k] = c[3] * inverse;
    above_[k] = c[5] * inverse;
    diagonal = subtract_product(c[6], below_[k], c[5]);
  }
}

template <class T>
bool BandLu<T>::factor_general() {
  const size_t diagonal = lower_ + upper_;
  bool regular = true;
  // at(i, j) = a_[j * height_ + diagonal + i - j]; rows above the band fill up through exchanges.
  for (size_t j = 0; j < n_; ++j) std::fill_n(a_.begin() + long(j * height_), lower_, T(0));
  size_t last = 0;  // last column that an exchange has reached
  for (size_t k = 0; k < n_; ++k) {
    if (k % 64 == 0) interruption_point();
    T* column = a_.data() + k * height_ + diagonal;  // column[i - k]
    const size_t rows = std::min(lower_, n_ - 1 - k);
    size_t p = 0;
    double best = magnitude(column[0]);
    for (size_t i = 1; i <= rows; ++i) {
      if (magnitude(column[i]) > best) best = magnitude(column[i]), p = i;
    }
    regular = regular && best > 0 && best < kHugePivot;
    pivot_[k] = k + p;
    last = std::max(last, std::min(k + p + upper_, n_ - 1));
    if (p != 0) {
      for (size_t j = k; j <= last; ++j) {
        T* c = a_.data() + j * height_ + diagonal + k - j;
        std::swap(c[0], c[p]);
      }
    }
    inverse_[k] = reciprocal(column[0]);
    for (size_t i = 1; i <= rows; ++i) column[i] *= inverse_[k];
    for (size_t j = k + 1; j <= last; ++j) {
      T* c = a_.data() + j * height_ + diagonal + k - j;
      const T u = c[0];
#pragma GCC ivdep
      for (size_t i = 1; i <= rows; ++i) c[i] -= column[i] * u;
    }
  }
  return regular;
}

template <class T>
void BandLu<T>::solve(T* b) const {
  if (recurrences_) {
    for (size_t k = 0; k + 1 < n_; ++k) b[k + 1] = subtract_product(b[k + 1], below_[k], b[k]);
    for (size_t k = 0; k < n_; ++k) b[k] *= inverse_[k];
    for (size_t k = n_ - 1; k-- > 0;) b[k] = subtract_product(b[k], above_[k], b[k + 1]);
    return;
  }
  const size_t diagonal = lower_ + upper_;
  for (size_t k = 0; k < n_; ++k) {
    std::swap(b[k], b[pivot_[k]]);
    const T* l = a_.data() + k * height_ + diagonal;
    const size_t rows = std::min(lower_, n_ - 1 - k);
    const T bk = b[k];
    for (size_t i = 1; i <= rows; ++i) b[k + i] -= l[i] * bk;
  }
  for (size_t k = n_; k-- > 0;) {
    const T* u = a_.data() + k * height_ + diagonal;
    const size_t rows = std::min(diagonal, k);
    const T bk = b[k] *= inverse_[k];
    T* x = b + k;
    for (size_t i = 1; i <= rows; ++i) *(x - i) -= *(u - i) * bk;
  }
}

template class BandLu<double>;
template class BandLu<Complex>;

}  // namespace truestep
