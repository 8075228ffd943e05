#include "engine/math/solvers/fft.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include "engine/math/trig.h"

namespace truestep {

namespace {

constexpr size_t kL = Fft::kLanes, kE = Fft::kElement;

// exp(-2 pi i k / n)
std::pair<double, double> root_of_unity(size_t k, size_t n) {
  k %= n;
  const auto sc = trig::sincos(2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
  return {sc.cos, -sc.sin};
}

template <size_t R>
[[gnu::always_inline]] inline void butterfly(std::array<double, R>& re, std::array<double, R>& im) {
  if constexpr (R == 2) {
    const double r = re[0] - re[1], i = im[0] - im[1];
    re[0] += re[1], im[0] += im[1], re[1] = r, im[1] = i;
  } else if constexpr (R == 3) {
    constexpr double kSin = 0.86602540378443864676;
    const double sr = re[1] + re[2], si = im[1] + im[2], dr = kSin * (re[1] - re[2]),
                 di = kSin * (im[1] - im[2]);
    const double mr = re[0] - 0.5 * sr, mi = im[0] - 0.5 * si;
    re[0] += sr, im[0] += si;
    re[1] = mr + di, im[1] = mi - dr;
    re[2] = mr - di, im[2] = mi + dr;
  } else if constexpr (R == 4) {
    const double ar = re[0] + re[2], ai = im[0] + im[2], br = re[0] - re[2], bi = im[0] - im[2];
    const double cr = re[1] + re[3], ci = im[1] + im[3], dr = re[1] - re[3], di = im[1] - im[3];
    re[0] = ar + cr, im[0] = ai + ci, re[2] = ar - cr, im[2] = ai - ci;
    re[1] = br + di, im[1] = bi - dr, re[3] = br - di, im[3] = bi + dr;
  } else {
    constexpr double kC1 = 0.30901699437494742410, kC2 = -0.80901699437494742410;
    constexpr double kS1 = 0.95105651629515357212, kS2 = 0.58778525229247312917;
    const double ar = re[1] + re[4], ai = im[1] + im[4], br = re[2] + re[3], bi = im[2] + im[3];
    const double cr = re[1] - re[4], ci = im[1] - im[4], dr = re[2] - re[3], di = im[2] - im[3];
    const double pr = re[0] + kC1 * ar + kC2 * br, pi = im[0] + kC1 * ai + kC2 * bi;
    const double qr = re[0] + kC2 * ar + kC1 * br, qi = im[0] + kC2 * ai + kC1 * bi;
    const double ur = kS1 * cr + kS2 * dr, ui = kS1 * ci + kS2 * di;
    const double vr = kS2 * cr - kS1 * dr, vi = kS2 * ci - kS1 * di;
    re[0] += ar + br, im[0] += ai + bi;
    re[1] = pr + ui, im[1] = pi - ur, re[4] = pr - ui, im[4] = pi + ur;
    re[2] = qr + vi, im[2] = qi - vr, re[3] = qr - vi, im[3] = qi + vr;
  }
}

// y[q + s (R p + j)] = w^(j p) sum_k x[q + s (p + k m)] exp(-2 pi i j k / R), length = R m.
template <size_t R>
void pass(size_t length, size_t s, const double* twiddles, const double* x, double* y) {
  const size_t m = length / R;
  for (size_t p = 0; p < m; ++p) {
    const double* w = twiddles + 2 * (R - 1) * p;
    double wr[R], wi[R];
    for (size_t j = 1; j < R; ++j) wr[j] = w[2 * j - 2], wi[j] = w[2 * j - 1];
    for (size_t q = 0; q < s; ++q) {
      const double* from = x + (q + s * p) * kE;
      double* to = y + (q + s * R * p) * kE;
#pragma GCC ivdep
      for (size_t l = 0; l < kL; ++l) {
        std::array<double, R> re, im;
#pragma GCC unroll 5
        for (size_t k = 0; k < R; ++k)
          re[k] = from[k * s * m * kE + l], im[k] = from[k * s * m * kE + kL + l];
        butterfly<R>(re, im);
        to[l] = re[0], to[kL + l] = im[0];
#pragma GCC unroll 5
        for (size_t j = 1; j < R; ++j) {
          to[j * s * kE + l] = re[j] * wr[j] - im[j] * wi[j];
          to[j * s * kE + kL + l] = re[j] * wi[j] + im[j] * wr[j];
        }
      }
    }
  }
}

bool smooth(size_t n) {
  for (const size_t f : {2, 3, 5}) {
    while (n % f == 0) n /= f;
  }
  return n == 1;
}

}  // namespace

// x_j c_j convolved with 1 / c, times c, c_j = exp(-pi i j^2 / n).
struct Fft::Chirp {
  explicit Chirp(size_t n) : inner(padded(n)), c(2 * n), transformed(2 * inner.size()) {
    const size_t m = inner.size();
    Buffer b(m * kE), scratch(inner.scratch_size());
    for (size_t j = 0; j < n; ++j) {
      const auto [re, im] = root_of_unity(j * j % (2 * n), 2 * n);
      c[2 * j] = re, c[2 * j + 1] = im;
      for (const size_t at : {j, (m - j) % m}) b[at * kE] = re, b[at * kE + kL] = -im;
    }
    inner.run(b.data(), scratch.data());
    for (size_t k = 0; k < m; ++k) {
      transformed[2 * k] = b[k * kE] / static_cast<double>(m);
      transformed[2 * k + 1] = b[k * kE + kL] / static_cast<double>(m);
    }
  }
  static size_t padded(size_t n) {
    size_t m = 2 * n - 1;
    while (!smooth(m)) ++m;
    return m;
  }
  Fft inner;
  std::vector<double> c, transformed;
};

Fft::~Fft() = default;
Fft::Fft(Fft&&) noexcept = default;

Fft::Fft(size_t n) : n_(n) {
  if (!smooth(n)) {
    chirp_ = std::make_unique<Chirp>(n);
    return;
  }
  size_t left = n, stride = 1;
  while (left > 1) {
    const size_t radix = left % 4 == 0 ? 4 : left % 2 == 0 ? 2 : left % 3 == 0 ? 3 : 5;
    Stage s{radix, left, stride, {}};
    for (size_t p = 0; p < left / radix; ++p) {
      for (size_t j = 1; j < radix; ++j) {
        const auto [re, im] = root_of_unity(j * p, left);
        s.twiddles.push_back(re), s.twiddles.push_back(im);
      }
    }
    stages_.push_back(std::move(s));
    left /= radix, stride *= radix;
  }
}

size_t Fft::scratch_size() const {
  return chirp_ ? chirp_->inner.size() * kE + chirp_->inner.scratch_size() : n_ * kE;
}

void Fft::run(double* x, double* scratch) const {
  if (!chirp_) {
    double *from = x, *to = scratch;
    for (const Stage& s : stages_) {
      const double* w = s.twiddles.data();
      switch (s.radix) {
        case 2:
          pass<2>(s.length, s.stride, w, from, to);
          break;
        case 3:
          pass<3>(s.length, s.stride, w, from, to);
          break;
        case 4:
          pass<4>(s.length, s.stride, w, from, to);
          break;
        default:
          pass<5>(s.length, s.stride, w, from, to);
      }
      std::swap(from, to);
    }
    if (from != x) std::copy_n(from, n_ * kE, x);
    return;
  }
  const Chirp& c = *chirp_;
  const size_t m = c.inner.size();
  double *padded = scratch, *rest = scratch + m * kE;
  const auto times = [](const double* a, double re, double im, double* out) {
    for (size_t l = 0; l < kL; ++l) {
      const double ar = a[l], ai = a[kL + l];
      out[l] = ar * re - ai * im, out[kL + l] = ar * im + ai * re;
    }
  };
  for (size_t j = 0; j < n_; ++j) times(x + j * kE, c.c[2 * j], c.c[2 * j + 1], padded + j * kE);
  std::fill(padded + n_ * kE, padded + m * kE, 0.0);
  c.inner.run(padded, rest);
  // Inverse by conjugates: conj(F(conj(a b))).
  for (size_t k = 0; k < m; ++k) {
    double* a = padded + k * kE;
    times(a, c.transformed[2 * k], c.transformed[2 * k + 1], a);
    for (size_t l = 0; l < kL; ++l) a[kL + l] = -a[kL + l];
  }
  c.inner.run(padded, rest);
  for (size_t j = 0; j < n_; ++j) {
    double* a = padded + j * kE;
    for (size_t l = 0; l < kL; ++l) a[kL + l] = -a[kL + l];
    times(a, c.c[2 * j], c.c[2 * j + 1], x + j * kE);
  }
}

}  // namespace truestep
