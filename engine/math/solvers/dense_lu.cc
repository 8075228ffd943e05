#include "engine/math/solvers/dense_lu.h"

#include <algorithm>

#include "engine/base/interrupt.h"

namespace truestep {

namespace {
constexpr size_t kPanel = 4;
constexpr double kHugeEntry = 1e300;

// c[i] -= sum_w l_w[i] u[w]
template <class T>
void subtract_product(size_t n, T* c, const T* l, size_t stride, const T* u, size_t width) {
  if (width == kPanel) {
    const T *l0 = l, *l1 = l + stride, *l2 = l + 2 * stride, *l3 = l + 3 * stride;
    const T u0 = u[0], u1 = u[1], u2 = u[2], u3 = u[3];
#pragma GCC ivdep
    for (size_t i = 0; i < n; ++i) c[i] -= (l0[i] * u0 + l1[i] * u1) + (l2[i] * u2 + l3[i] * u3);
    return;
  }
  for (size_t w = 0; w < width; ++w) {
    const T* lw = l + w * stride;
    const T uw = u[w];
#pragma GCC ivdep
    for (size_t i = 0; i < n; ++i) c[i] -= lw[i] * uw;
  }
}
}  // namespace

template <class T>
void DenseLu<T>::resize(size_t n) {
  n_ = n;
  a_.resize(n * n);
  inverse_.resize(n);
  pivot_.resize(n);
}

// Eliminates within the columns [first, first + width); rows are exchanged in these columns only.
template <class T>
bool DenseLu<T>::factor_panel(size_t first, size_t width) {
  interruption_point();
  const size_t end = first + width;
  bool regular = true;
  for (size_t k = first; k < end; ++k) {
    T* column = a_.data() + k * n_;
    size_t p = k;
    double best = magnitude(column[k]);
    for (size_t i = k + 1; i < n_; ++i) {
      if (magnitude(column[i]) > best) best = magnitude(column[i]), p = i;
    }
    regular = regular && best > 0 && best < kHugeEntry;
    pivot_[k] = p;
    if (p != k) {
      for (size_t j = first; j < end; ++j) std::swap(a_[j * n_ + k], a_[j * n_ + p]);
    }
    inverse_[k] = reciprocal(column[k]);
#pragma GCC ivdep
    for (size_t i = k + 1; i < n_; ++i) column[i] *= inverse_[k];
    for (size_t j = k + 1; j < end; ++j) {
      T* c = a_.data() + j * n_;
      subtract_product(n_ - k - 1, c + k + 1, column + k + 1, n_, c + k, 1);
    }
  }
  return regular;
}

// Updates the columns behind a panel: exchanges, the panel's unit triangle, then the product.
template <class T>
void DenseLu<T>::update_columns(size_t first, size_t width) {
  const size_t end = first + width;
  const T* panel = a_.data() + first * n_;
  for (size_t j = 0; j < n_; ++j) {
    if (j == first) j = end;
    if (j >= n_) break;
    T* c = a_.data() + j * n_;
    for (size_t k = first; k < end; ++k) std::swap(c[k], c[pivot_[k]]);
    if (j < first) continue;
    for (size_t k = first; k + 1 < end; ++k) {
      for (size_t i = k + 1; i < end; ++i) c[i] -= panel[(k - first) * n_ + i] * c[k];
    }
    subtract_product(n_ - end, c + end, panel + end, n_, c + first, width);
  }
}

template <class T>
bool DenseLu<T>::factor() {
  bool regular = true;
  for (size_t first = 0; first < n_; first += kPanel) {
    const size_t width = std::min(kPanel, n_ - first);
    regular = factor_panel(first, width) && regular;
    update_columns(first, width);
  }
  return regular;
}

template <class T>
void DenseLu<T>::solve(T* b) const {
  for (size_t k = 0; k < n_; ++k) std::swap(b[k], b[pivot_[k]]);
  for (size_t k = 0; k + 1 < n_; ++k) {
    const T* l = a_.data() + k * n_;
    const T bk = b[k];
#pragma GCC ivdep
    for (size_t i = k + 1; i < n_; ++i) b[i] -= l[i] * bk;
  }
  for (size_t k = n_; k-- > 0;) {
    const T* u = a_.data() + k * n_;
    const T bk = b[k] *= inverse_[k];
#pragma GCC ivdep
    for (size_t i = 0; i < k; ++i) b[i] -= u[i] * bk;
  }
}

template class DenseLu<double>;
template class DenseLu<Complex>;

}  // namespace truestep
