// Reduction to r and evaluation as hi + lo ("double-double") where one rounding would cost too much; see
// Muller 2016, "Elementary functions", chapters 4 (sums and products with error), 9 and 10 (reduction).
#include "engine/math/trig.h"

#include <algorithm>
#include <array>
#include <limits>

namespace truestep::trig {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kLn2Hi = 0x1.62e42fefa3800p-1;  // 42 bits: k * kLn2Hi is exact
constexpr double kLn2Lo = 0x1.ef35793c76730p-45;

struct Pair {
  double hi, lo;
};
Pair two_sum(double a, double b) {
  const double s = a + b, bb = s - a;
  return {s, (a - (s - bb)) + (b - bb)};
}
Pair two_product(double a, double b) {
  const double p = a * b;
  return {p, std::fma(a, b, -p)};
}

// 2^k for -1022 <= k <= 1023.
double power_of_two(int k) {
  return std::bit_cast<double>(static_cast<uint64_t>(k + 1023) << 52);
}

// e^(hi + lo), |lo| far below |hi|.
double exp_pair(double hi, double lo) {
  if (!(hi <= 709.8)) return std::isnan(hi) ? hi : kInf;
  if (hi < -745.2) return 0;
  const double k = std::fma(hi, 0x1.71547652b82fep+0, 0x1.8p52) - 0x1.8p52;
  const double a = std::fma(-k, kLn2Hi, hi), b = std::fma(k, kLn2Lo, -lo);
  const double r = a - b, r_lo = (a - r) - b;
  double q = 0x1.af857783c0fe7p-26;
  for (const double c : {0x1.28b03ea596254p-22, 0x1.71dddfd63107ep-19, 0x1.a019969ec7d59p-16,
                         0x1.a01a01badd870p-13, 0x1.6c16c185a35b1p-10, 0x1.111111110d648p-7,
                         0x1.5555555550042p-5, 0x1.5555555555561p-3, 0x1.000000000000bp-1}) {
    q = std::fma(q, r, c);
  }
  const double p = std::fma(r * r, q, std::fma(r_lo, r, r_lo));
  const double s = r + p, s_lo = (r - s) + p;
  const double y = 1 + s, y_lo = ((1 - y) + s) + s_lo;
  const int n = static_cast<int>(k), half = n / 2;
  return (y + y_lo) * power_of_two(half) * power_of_two(n - half);
}

// x = 2^k m with m in [sqrt(1/2), sqrt(2)), for positive finite x.
struct Split {
  double k, m;
};
Split split(double x) {
  double k = 0;
  if (x < 0x1p-1022) x *= 0x1p54, k = -54;
  const auto bits = std::bit_cast<int64_t>(x);
  const int64_t e = (bits - std::bit_cast<int64_t>(0x1.6a09e667f3bcdp-1)) >> 52;
  return {k + static_cast<double>(e), std::bit_cast<double>(bits - (e << 52))};
}

// log x to about 64 bits, for positive finite x: 2 atanh s with s = (m - 1) / (m + 1), two terms exact.
Pair log_pair(double x) {
  const auto [k, m] = split(x);
  const double f = m - 1, d = 2 + f, d_lo = f - (d - 2);
  const double s = f / d, s_lo = (std::fma(-s, d, f) - s * d_lo) / d;
  Pair z = two_product(s, s);
  z.lo += 2 * s * s_lo;
  Pair t = two_product(s, z.hi);
  t.lo += s * z.lo + s_lo * z.hi;
  Pair u = two_product(t.hi, 0x1.5555555555555p-1);
  u.lo += t.hi * 0x1.5555555555555p-55 + t.lo * 0x1.5555555555555p-1;
  double w = 0x1.0e423dc14ace0p-3;
  for (const double c : {0x1.0f7ff55e85ccap-3, 0x1.3b1eeb8bc0e14p-3, 0x1.745ce9e60e7c9p-3,
                         0x1.c71c722d5ec11p-3, 0x1.2492492457dafp-2, 0x1.9999999999b30p-2}) {
    w = std::fma(w, z.hi, c);
  }
  w *= t.hi * z.hi;
  const Pair h = two_sum(2 * s, u.hi);
  const Pair g = two_sum(k * kLn2Hi, h.hi);
  const double lo = g.lo + ((h.lo + (2 * s_lo + u.lo)) + w + k * kLn2Lo);
  const double hi = g.hi + lo;
  return {hi, lo - (hi - g.hi)};
}

// Angle of (b, a) for a, b >= 0, not both 0, of moderate size: atan c + atan of the rest, for one of five c.
Pair angle(Pair a, Pair b) {
  constexpr std::array<Pair, 5> kAtan = {{{0, 0},
                                          {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                          {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
                                          {0x1.f730bd281f69bp-1, 0x1.007887af0cbbdp-56},
                                          {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54}}};
  // Numerator a p - b q and denominator b p + a q with c = q / p.
  constexpr std::array<Pair, 5> kFraction = {{{1, 0}, {2, 1}, {1, 1}, {2, 3}, {0, 1}}};
  const double x = a.hi, y = b.hi;
  const size_t i = 16 * x < 7 * y ? 0 : 16 * x < 11 * y ? 1 : 16 * x < 19 * y ? 2 : 16 * x < 39 * y ? 3 : 4;
  const auto [p, q] = kFraction[i];
  const Pair ap = two_product(x, p), bq = two_product(y, q), bp = two_product(y, p), aq = two_product(x, q);
  Pair n = two_sum(ap.hi, -bq.hi), d = two_sum(bp.hi, aq.hi);
  n.lo += (ap.lo - bq.lo) + (a.lo * p - b.lo * q);
  d.lo += (bp.lo + aq.lo) + (b.lo * p + a.lo * q);
  const double t = n.hi / d.hi, t_lo = ((std::fma(-t, d.hi, n.hi) + n.lo) - t * d.lo) / d.hi;
  const double z = t * t;
  double w = 0x1.c0e669668212ap-7;
  for (const double c :
       {-0x1.0584dce3d3bf6p-5, 0x1.6b2dfe69379a2p-5, -0x1.a9ffe4e27024fp-5, 0x1.e1336c0b3155bp-5,
        -0x1.1109129cbe135p-4, 0x1.3b13304e45be6p-4, -0x1.745d11d4abc16p-4, 0x1.c71c71a18dfddp-4,
        -0x1.24924924462f2p-3, 0x1.9999999998fecp-3, -0x1.5555555555552p-2}) {
    w = std::fma(w, z, c);
  }
  const Pair s = two_sum(kAtan[i].hi, t);
  return {s.hi, s.lo + (std::fma(z * t, w, std::fma(-z, t_lo, t_lo)) + kAtan[i].lo)};
}

// Sign and half-plane of an angle in the first quadrant.
double place(Pair angle, double y, double x) {
  if (std::signbit(x)) {
    const Pair s = two_sum(0x1.921fb54442d18p+1, -angle.hi);
    angle = {s.hi, s.lo - angle.lo + 0x1.1a62633145c07p-53};
  }
  return std::copysign(angle.hi + angle.lo, y);
}

// sqrt(1 - x^2) for |x| <= 1.
Pair complement(double x) {
  const Pair p = two_product(x, x);
  const Pair w = two_sum(1, -p.hi);
  const double r = std::sqrt(w.hi);
  return {r, r > 0 ? ((std::fma(-r, r, w.hi) + w.lo) - p.lo) / (2 * r) : 0};
}

}  // namespace

namespace detail {

Reduced reduce_huge(double x) {
  // A zero word, then the binary digits of 2/pi after the point.
  static constexpr std::array<uint64_t, 21> kTwoOverPi = {0,
                                                          0xa2f9836e4e441529,
                                                          0xfc2757d1f534ddc0,
                                                          0xdb6295993c439041,
                                                          0xfe5163abdebbc561,
                                                          0xb7246e3a424dd2e0,
                                                          0x06492eea09d1921c,
                                                          0xfe1deb1cb129a73e,
                                                          0xe88235f52ebb4484,
                                                          0xe99c7026b45f7e41,
                                                          0x3991d639835339f4,
                                                          0x9c845f8bbdf9283b,
                                                          0x1ff897ffde05980f,
                                                          0xef2f118b5a0a6d1f,
                                                          0x6d367ecf27cb09b7,
                                                          0x4f463f669e5fea2d,
                                                          0x7527bac7ebe5f17b,
                                                          0x3d0739f78a5292ea,
                                                          0x6bfb5fb11f8d5d08,
                                                          0x56033046fc7b6bab,
                                                          0xf0cfbc209af4361d};
  __extension__ using Wide = unsigned __int128;
  if (!std::isfinite(x)) return {kNaN, 0, 0};
  const auto bits = std::bit_cast<uint64_t>(x);
  const uint64_t m = (bits & 0xfffffffffffff) | (uint64_t{1} << 52);
  const int e = static_cast<int>(bits >> 52 & 0x7ff) - 1075;  // |x| = m 2^e, e >= -22 here
  // 192 digits starting at the one whose product with 2^e has weight 2: digits before it only add multiples
  // of 4.
  const auto position = static_cast<size_t>(int64_t{e} - 1 + 63);
  const size_t word = position / 64, shift = position % 64;
  const auto digits = [&](size_t i) {
    return kTwoOverPi[word + i] << shift | (shift ? kTwoOverPi[word + i + 1] >> (64 - shift) : 0);
  };
  const Wide low = Wide{m} * digits(2);
  const Wide mid = Wide{m} * digits(1) + static_cast<uint64_t>(low >> 64);
  const uint64_t w2 = m * digits(0) + static_cast<uint64_t>(mid >> 64);
  const auto w1 = static_cast<uint64_t>(mid), w0 = static_cast<uint64_t>(low);
  // Two bits of quadrant, then the fraction, rounded to (-1/2, 1/2].
  auto quadrant = static_cast<int>(w2 >> 62);
  uint64_t f1 = w2 << 2 | w1 >> 62, f0 = w1 << 2 | w0 >> 62;
  double sign = 1;
  if (f1 >> 63) {
    ++quadrant, sign = -1;
    f1 = ~f1, f0 = ~f0;  // 2^-128 off, far below what is kept
  }
  const int zeros = std::countl_zero(f1 | 1);
  if (zeros) f1 = f1 << zeros | f0 >> (64 - zeros), f0 <<= zeros;
  const double scale = power_of_two(-zeros) * sign;
  const double hi = static_cast<double>(f1 >> 11) * 0x1p-53 * scale;
  const double lo = static_cast<double>((f1 << 53 | f0 >> 11) >> 11) * 0x1p-106 * scale;
  Pair p = two_product(hi, 0x1.921fb54442d18p+0);
  p.lo += hi * 0x1.1a62633145c07p-54 + lo * 0x1.921fb54442d18p+0;
  const double sum = p.hi + p.lo, rest = p.lo - (sum - p.hi);
  return bits >> 63 ? Reduced{-sum, -rest, -quadrant & 3} : Reduced{sum, rest, quadrant & 3};
}

}  // namespace detail

double tan(double x) {
  const SinCos sc = sincos(x);
  return sc.sin / sc.cos;
}

double exp(double x) {
  return exp_pair(x, 0);
}

double log(double x) {
  if (!(x > 0)) return x == 0 ? -kInf : kNaN;
  if (x == kInf) return x;
  const auto [k, m] = split(x);
  const double f = m - 1, s = f / (2 + f), z = s * s, half = 0.5 * f * f;
  double r = 0x1.2f057abac6719p-3;
  for (const double c : {0x1.39a1b88b9da54p-3, 0x1.74663efc9bd1bp-3, 0x1.c71c520901dc1p-3,
                         0x1.24924941f18aap-2, 0x1.999999997fdb1p-2, 0x1.5555555555592p-1}) {
    r = std::fma(r, z, c);
  }
  return k * kLn2Hi - ((half - std::fma(s, std::fma(r, z, half), k * kLn2Lo)) - f);
}

double pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (std::isnan(x) || std::isnan(y)) return kNaN;
  const double size = std::abs(x);
  if (std::isinf(y)) return size == 1 ? 1 : (size > 1) == (y > 0) ? kInf : 0;
  const bool whole = std::trunc(y) == y;
  const bool odd = whole && std::abs(y) < 0x1p53 && static_cast<int64_t>(y) % 2 != 0;
  const double sign = odd && std::signbit(x) ? -1 : 1;
  if (size == 0) return sign * (y > 0 ? 0 : kInf);
  if (std::isinf(x)) return sign * (y > 0 ? kInf : 0);
  if (x < 0 && !whole) return kNaN;
  const Pair l = log_pair(size);
  const Pair p = two_product(y, l.hi);
  if (!(std::abs(p.hi) < 1000)) return sign * (p.hi > 0 ? kInf : 0);
  return sign * exp_pair(p.hi, std::fma(y, l.lo, p.lo));
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNaN;
  double a = std::abs(y), b = std::abs(x);
  if (a == 0 && b == 0) b = 1;
  if (std::isinf(a) || std::isinf(b)) {
    const bool both = std::isinf(a) && std::isinf(b);
    b = std::isinf(b) ? 1 : 0;
    a = both || b == 0 ? 1 : 0;
  }
  const double largest = std::max(a, b);
  if (largest > 0x1p900) a *= 0x1p-200, b *= 0x1p-200;
  if (largest < 0x1p-800) a *= 0x1p250, b *= 0x1p250;
  return place(angle({a, 0}, {b, 0}), y, x);
}

double atan(double x) {
  return atan2(x, 1);
}

double acos(double x) {
  if (!(std::abs(x) <= 1)) return kNaN;
  return place(angle(complement(x), {std::abs(x), 0}), 1, x);
}

double asin(double x) {
  if (!(std::abs(x) <= 1)) return kNaN;
  return place(angle({std::abs(x), 0}, complement(x)), x, 1);
}

}  // namespace truestep::trig
