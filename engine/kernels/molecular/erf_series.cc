#include "engine/kernels/molecular/erf_series.h"

#include "engine/math/trig.h"

namespace truestep::molecular {

ErfSeries::One ErfSeries::exact(double u) {
  constexpr double kTwoOverRootPi = 1.1283791670955126;
  // G = -2 dE/du: with E = c e^-u S, S' = sum k 2^k u^(k-1) / (2k+1)!!, so G = 2 c e^-u (S - S'), and
  // S - S' = sum (2u)^k / (2k+1)!! (1 - 2 (k+1) / (2k+3)) = sum (2u)^k / ((2k+1)!! (2k+3)).
  double term = 1, e = 0, g = 0;
  for (int k = 0; k < 400; ++k) {
    e += term, g += term / (2 * k + 3);
    term *= 2 * u / (2 * k + 3);
    if (term < 1e-18 * e && 2 * u < k) break;
  }
  const double c = kTwoOverRootPi * trig::exp(-u);
  return {c * e, 2 * c * g};
}

std::vector<ErfSeries::Pair> ErfSeries::split(const std::vector<double>& c) {
  // T_2k+1 = t R_k with R_0 = 1, R_k = 2 T_k(s) - R_k-1: every odd coefficient contributes to all lower d,
  // with alternating sign.
  std::vector<Pair> out(c.size() / 2);
  double below = 0;
  for (size_t k = out.size(); k-- > 0;) {
    below = c[2 * k + 1] - below;
    out[k] = {Wide<double>(c[2 * k]), Wide<double>(k > 0 ? 2 * below : below)};
  }
  return out;
}

ErfSeries::ErfSeries(double u_max, double least) : scale_(2 / u_max) {
  constexpr double kHalfTurn = 3.141592653589793;
  constexpr int kNodes = 80;
  std::vector<One> f(kNodes);
  for (int j = 0; j < kNodes; ++j) f[j] = exact((trig::cos(kHalfTurn * (j + 0.5) / kNodes) + 1) / scale_);
  std::vector<double> e(kNodes), g(kNodes);
  size_t used = 2;
  for (size_t k = 0; k < kNodes; ++k) {
    for (size_t j = 0; j < kNodes; ++j) {
      const size_t turns = (k * (2 * j + 1)) % (4 * kNodes);
      const double c = trig::cos(kHalfTurn * static_cast<double>(turns) / (2.0 * kNodes));
      e[k] += 2.0 / kNodes * f[j].e * c, g[k] += 2.0 / kNodes * f[j].g * c;
    }
    if (std::abs(e[k]) > least || std::abs(g[k]) > least) used = k + 1;
  }
  e[0] *= 0.5, g[0] *= 0.5;
  used += used % 2;
  e.resize(used), g.resize(used);
  e_ = split(e), g_ = split(g);
}

}  // namespace truestep::molecular
