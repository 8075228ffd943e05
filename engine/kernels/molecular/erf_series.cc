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

ErfSeries::ErfSeries(double u_max) : scale_(2 / u_max) {
  constexpr double kHalfTurn = 3.141592653589793;
  constexpr int kNodes = 80;
  std::vector<One> f(kNodes);
  for (int j = 0; j < kNodes; ++j) f[j] = exact((trig::cos(kHalfTurn * (j + 0.5) / kNodes) + 1) / scale_);
  e_.assign(kNodes, 0), g_.assign(kNodes, 0);
  size_t used = 1;
  for (int k = 0; k < kNodes; ++k) {
    for (int j = 0; j < kNodes; ++j) {
      const double c = trig::cos(kHalfTurn * ((k * (2 * j + 1)) % (4 * kNodes)) / (2.0 * kNodes));
      e_[k] += 2.0 / kNodes * f[j].e * c, g_[k] += 2.0 / kNodes * f[j].g * c;
    }
    if (std::abs(e_[k]) > 2e-16 || std::abs(g_[k]) > 2e-16) used = static_cast<size_t>(k) + 1;
  }
  e_[0] *= 0.5, g_[0] *= 0.5;
  e_.resize(used), g_.resize(used);
}

}  // namespace truestep::molecular
