#include "engine/math/solvers/trig_transform.h"

#include <algorithm>
#include <numbers>

namespace truestep {

namespace {
using End = TrigTransform::End;
constexpr size_t kLanes = Fft::kLanes, kElement = Fft::kElement;

size_t extended(End low, End high, size_t n) {
  return low == End::periodic ? n : low == high ? 2 * n : 4 * n;
}
}  // namespace

TrigTransform::TrigTransform(End low, End high, size_t n)
    : low_(low), high_(high), n_(n), fft_(extended(low, high, n)) {}

double TrigTransform::angle(size_t i) const {
  const auto k = static_cast<double>(i), n = static_cast<double>(n_);
  if (low_ == End::periodic) return 2 * std::numbers::pi * k / n;
  if (low_ == high_) return std::numbers::pi * k / n;
  // The slowest wave is at the even end, last or first.
  return std::numbers::pi * (low_ == End::zero ? k - 0.5 : n - k - 0.5) / n;
}

size_t TrigTransform::scratch_size() const {
  return fft_.size() * kElement + fft_.scratch_size();
}

void TrigTransform::forward(double* x, size_t node_stride, size_t line_stride, size_t count,
                            double* scratch) const {
  run(Way::forward, x, node_stride, line_stride, count, scratch);
}
void TrigTransform::backward(double* x, size_t node_stride, size_t line_stride, size_t count,
                             double* scratch) const {
  run(Way::backward, x, node_stride, line_stride, count, scratch);
}

void TrigTransform::run(Way way, double* x, size_t node_stride, size_t line_stride, size_t count,
                        double* scratch) const {
  const size_t total = fft_.size(), n = n_;
  double *e = scratch, *rest = scratch + total * kElement;
  const bool mixed = low_ != high_;
  // Mixed ends are always handled from the zero end: index j counts from there.
  const auto node = [&](size_t j) { return mixed && low_ == End::even ? n - j : j; };
  const auto load = [&](size_t j, double* to) {
    const double* from = x + node(j) * node_stride;
    if (line_stride == 1 && count == kLines) {
      std::copy_n(from, kLines, to);
      return;
    }
    for (size_t l = 0; l < count; ++l) to[l] = from[l * line_stride];
    for (size_t l = count; l < kLines; ++l) to[l] = 0;
  };
  const auto store = [&](size_t j, const double* v) {
    double* to = x + node(j) * node_stride;
    if (line_stride == 1 && count == kLines) {
      std::copy_n(v, kLines, to);
      return;
    }
    for (size_t l = 0; l < count; ++l) to[l * line_stride] = v[l];
  };
  const auto at = [&](size_t j) { return e + j * kElement; };
  const auto zero = [&](size_t j) { std::fill_n(at(j), kElement, 0.0); };
  const auto copy = [&](size_t to, size_t from) { std::copy_n(at(from), kElement, at(to)); };
  const auto negate = [&](size_t to, size_t from) {
    for (size_t l = 0; l < kElement; ++l) at(to)[l] = -at(from)[l];
  };
  double values[kElement];
  // For odd extensions, a line in the real lanes ends up in the imaginary ones: -2i S.
  const auto store_odd = [&](size_t j, size_t k, double scale) {
    const double* z = at(k);
    for (size_t l = 0; l < kLanes; ++l) values[l] = -scale * z[kLanes + l], values[kLanes + l] = scale * z[l];
    store(j, values);
  };
  const auto length = static_cast<double>(n);

  if (low_ == End::periodic) {
    for (size_t j = 0; j < n; ++j) load(j, at(j));
    fft_.run(e, rest);
    const double scale = way == Way::forward ? 0.5 : 0.5 / length;
    for (size_t k = 0; k < n; ++k) {
      const double *z = at(k), *m = at((n - k) % n);
      for (size_t l = 0; l < kLanes; ++l) {
        values[l] = scale * ((z[l] + m[l]) - (z[kLanes + l] - m[kLanes + l]));
        values[kLanes + l] = scale * ((z[kLanes + l] + m[kLanes + l]) + (z[l] - m[l]));
      }
      store(k, values);
    }
  } else if (!mixed && low_ == End::zero) {
    zero(0), zero(n);
    for (size_t j = 1; j < n; ++j) load(j, at(j)), negate(2 * n - j, j);
    fft_.run(e, rest);
    const double scale = way == Way::forward ? 0.5 : 1 / length;
    for (size_t k = 1; k < n; ++k) store_odd(k, k, scale);
  } else if (!mixed) {
    for (size_t j = 0; j <= n; ++j) load(j, at(j));
    for (size_t j = 1; j < n; ++j) copy(2 * n - j, j);
    fft_.run(e, rest);
    const double scale = way == Way::forward ? 1 : 0.5 / length;
    for (size_t k = 0; k <= n; ++k) {
      for (size_t l = 0; l < kElement; ++l) values[l] = scale * at(k)[l];
      store(k, values);
    }
  } else if (way == Way::forward) {
    zero(0), zero(2 * n);
    for (size_t j = 1; j <= n; ++j) {
      load(j, at(j));
      if (j < n) copy(2 * n - j, j);
    }
    for (size_t j = 1; j < 2 * n; ++j) negate(4 * n - j, j);
    fft_.run(e, rest);
    for (size_t k = 0; k < n; ++k) store_odd(k + 1, 2 * k + 1, 0.25);
  } else {
    for (size_t k = 0; k < n; ++k) {
      zero(2 * k), zero(2 * n + 2 * k);
      load(k + 1, at(2 * k + 1));
      negate(4 * n - (2 * k + 1), 2 * k + 1);
    }
    fft_.run(e, rest);
    for (size_t j = 1; j <= n; ++j) store_odd(j, j, 1 / length);
  }
}

}  // namespace truestep
