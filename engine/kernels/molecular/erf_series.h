// erf(z) / z and minus its slope over z, as Chebyshev series in u = z^2 on [0, u_max]; both are entire in u:
//   E(u) = erf(z) / z = 2/sqrt(pi) exp(-u) sum_k (2 u)^k / (1 3 5 ... (2k+1)),    G(u) = -2 dE/du
// The coefficients come from the series above (all its terms are positive), so that no libm is needed and
// every machine has the same bits. What a pair's charges need: the part of 1/r that Ewald's sum takes over is
// alpha E(alpha^2 r^2), and the force over r of it alpha^3 G(alpha^2 r^2).
#pragma once
#include <vector>

#include "engine/math/wide.h"

namespace truestep::molecular {

class ErfSeries {
 public:
  ErfSeries() = default;
  /// Good to some 1e-15 of E(0) for u up to `u_max` (at most 40).
  explicit ErfSeries(double u_max);

  struct Pair {
    Wide<double> e, g;
  };
  struct One {
    double e, g;
  };
  Pair at(Wide<double> u) const {
    const Wide<double> t2 = u * Wide<double>(2 * scale_) - Wide<double>(2.0);  // 2 t
    Wide<double> e1 = Wide<double>::zero(), e2 = e1, g1 = e1, g2 = e1;
    for (size_t k = e_.size() - 1; k > 0; --k) {
      const Wide<double> e0 = madd(t2, e1, Wide<double>(e_[k]) - e2),
                         g0 = madd(t2, g1, Wide<double>(g_[k]) - g2);
      e2 = e1, e1 = e0, g2 = g1, g1 = g0;
    }
    const Wide<double> t = t2 * Wide<double>(0.5);
    return {madd(t, e1, Wide<double>(e_[0]) - e2), madd(t, g1, Wide<double>(g_[0]) - g2)};
  }
  One at(double u) const {
    const Pair p = at(Wide<double>(u));
    return {p.e[0], p.g[0]};
  }
  double u_max() const { return 2 / scale_; }

  /// The series above itself: E and G at u (0 to 60), slowly.
  static One exact(double u);

 private:
  double scale_ = 1;  // t = scale u - 1 in [-1, 1]
  std::vector<double> e_{0.0}, g_{0.0};
};

}  // namespace truestep::molecular
