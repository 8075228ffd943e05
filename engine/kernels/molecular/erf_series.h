// erf(z) / z and minus its slope over z, as Chebyshev series in u = z^2 on [0, u_max]; both are entire in u:
//   E(u) = erf(z) / z = 2/sqrt(pi) exp(-u) sum_k (2 u)^k / (1 3 5 ... (2k+1)),    G(u) = -2 dE/du
// The coefficients come from the series above (all its terms are positive), so no libm is needed and every
// machine gives the same bits. For a pair of charges: the part of 1/r included in Ewald's reciprocal sum is
// alpha E(alpha^2 r^2), and its force over r is alpha^3 G(alpha^2 r^2). The terms of even and of odd order
// are summed side by side (Clenshaw's recurrence waits for itself):
//   sum_k c_2k T_2k(t) = sum_k c_2k T_k(s),    sum_k c_2k+1 T_2k+1(t) = t sum_k d_k T_k(s),    s = 2 t^2 - 1
#pragma once
#include <cstddef>
#include <vector>

#include "engine/math/wide.h"

namespace truestep::molecular {

class ErfSeries {
 public:
  ErfSeries() = default;
  /// For u up to `u_max` (at most 40). Terms below `least` are dropped; the error is about 1e-15.
  explicit ErfSeries(double u_max, double least = 2e-16);

  Wide<double> e(Wide<double> u) const { return sum(e_, u); }
  Wide<double> g(Wide<double> u) const { return sum(g_, u); }
  struct One {
    double e, g;
  };
  One at(double u) const { return {e(Wide<double>(u))[0], g(Wide<double>(u))[0]}; }
  double u_max() const { return 2 / scale_; }

  /// Evaluates the series above directly: E and G at u (0 to 60), slowly.
  static One exact(double u);

 private:
  /// Coefficients of T_k(s), in every lane.
  struct Pair {
    Wide<double> even, odd;
  };
  static std::vector<Pair> split(const std::vector<double>& c);
  Wide<double> sum(const std::vector<Pair>& c, Wide<double> u) const {
    using W = Wide<double>;
    const W t = u * W(scale_) - W(1.0), s2 = t * t * W(4.0) - W(2.0);  // 2 s
    W a1 = W::zero(), a2 = a1, b1 = a1, b2 = a1;
    for (size_t k = c.size(); k-- > 1;) {
      const W a0 = madd(s2, a1, c[k].even - a2), b0 = madd(s2, b1, c[k].odd - b2);
      a2 = a1, a1 = a0, b2 = b1, b1 = b0;
    }
    const W s = s2 * W(0.5);
    return madd(t, madd(s, b1, c[0].odd - b2), madd(s, a1, c[0].even - a2));
  }

  double scale_ = 1;  // t = scale u - 1 in [-1, 1]
  std::vector<Pair> e_, g_;
};

}  // namespace truestep::molecular
