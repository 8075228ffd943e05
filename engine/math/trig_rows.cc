// The same operations as trig::sincos without its branches, so that the loop vectorises. The number of
// quarter turns is read from the low bits of x 2/pi + 1.5 2^52. Huge arguments go one by one.
#include "engine/math/trig_rows.h"

#include "engine/math/trig.h"

namespace truestep::trig {

namespace {

enum class Wanted { sine, cosine };

/// |x| < 2^30.
template <Wanted wanted>
inline double moderate(double x) {
  constexpr double kP1 = 0x1.921fb54442d18p+0, kP2 = 0x1.1a62633145c07p-54, kP3 = -0x1.f1976b7ed8fbcp-110;
  constexpr double kRound = 0x1.8p52;
  const double turns = std::fma(x, 0x1.45f306dc9c883p-1, kRound);
  const double shifted = std::fabs(x) <= 0x1.921fb54442d18p-1 ? kRound : turns;
  const double k = shifted - kRound;
  const double p = k * kP1, p_lo = std::fma(k, kP1, -p);
  const double r = x - p;
  const double q = k * kP2, q_lo = std::fma(k, kP2, -q);
  const double s = p_lo + q, s_lo = (p_lo - (s - q)) + (q - (s - (s - q)));
  const double hi = r - s;
  const double b = r - hi;
  const double lo = ((b - s) + (r - (hi + b))) - (s_lo + q_lo + k * kP3);
  const double sum = hi + lo, rest = lo - (sum - hi);
  const double sine = detail::sin_kernel(sum, rest), cosine = detail::cos_kernel(sum, rest);
  const uint64_t quadrant = std::bit_cast<uint64_t>(shifted) + (wanted == Wanted::cosine ? 1 : 0);
  const double value = (quadrant & 1) != 0 ? cosine : sine;
  // The sign changes in quadrants 2 and 3.
  return std::bit_cast<double>(std::bit_cast<uint64_t>(value) ^ (quadrant & 2) << 62);
}

template <Wanted wanted>
void rows(const double* x, double* out, size_t n) {
  double largest = 0;
  bool ordinary = true;
  for (size_t k = 0; k < n; ++k) {
    largest = std::fabs(x[k]) > largest ? std::fabs(x[k]) : largest;
    ordinary &= x[k] == x[k];
  }
  if (!(largest < 0x1p30) || !ordinary) {
    for (size_t k = 0; k < n; ++k) out[k] = wanted == Wanted::sine ? sin(x[k]) : cos(x[k]);
    return;
  }
#pragma GCC ivdep
  for (size_t k = 0; k < n; ++k) out[k] = moderate<wanted>(x[k]);
}

}  // namespace

void sin_rows(const double* x, double* out, size_t n) {
  rows<Wanted::sine>(x, out, n);
}
void cos_rows(const double* x, double* out, size_t n) {
  rows<Wanted::cosine>(x, out, n);
}

}  // namespace truestep::trig
