// How the points that a body rests on share its load: the forces N_p >= 0 of least sum of squares with
//   sum N_p c_p = W,   sum N_p c_p (x_p, y_p) = M,
// where c is the cosine of the angle between a point's normal and the vertical, (x, y) the point's horizontal
// position, W the load and M its moments. Points that would have to pull are removed one at a time. Where no
// such forces exist, as under a body that topples, the points bear it as if its load acted at the nearest
// place within their bounds: the remaining moments turn the body.
#pragma once
#include <algorithm>
#include <cmath>
#include <span>

namespace truestep {

struct BearingPoint {
  double x = 0, y = 0;  ///< m from the body's centre
  double cosine = 1;    ///< positive
  double force = 0;     ///< N, the result
  bool bears = true;
};

namespace detail {

/// Solves the symmetric system K u = b, K by rows (xx xy xz yy yz zz), with a small addition to its diagonal
/// so that it is never singular.
inline void solve_stiffened(const double K[6], const double b[3], double u[3]) {
  const double more = 1e-9 * (K[0] + K[3] + K[5]);
  const double l00 = std::sqrt(K[0] + more), l10 = K[1] / l00, l20 = K[2] / l00;
  const double l11 = std::sqrt(std::max(K[3] + more - l10 * l10, more)), l21 = (K[4] - l10 * l20) / l11;
  const double l22 = std::sqrt(std::max(K[5] + more - l20 * l20 - l21 * l21, more));
  const double y0 = b[0] / l00, y1 = (b[1] - l10 * y0) / l11, y2 = (b[2] - l20 * y0 - l21 * y1) / l22;
  u[2] = y2 / l22, u[1] = (y1 - l21 * u[2]) / l11, u[0] = (y0 - l10 * u[1] - l20 * u[2]) / l00;
}

}  // namespace detail

/// Sets the forces of the points for a load (N) and its moments (N m).
inline void share_load(std::span<BearingPoint> points, double load, double moment_x, double moment_y) {
  double reach = 0, low_x = HUGE_VAL, high_x = -HUGE_VAL, low_y = HUGE_VAL, high_y = -HUGE_VAL;
  for (const BearingPoint& p : points) {
    reach = std::max({reach, std::abs(p.x), std::abs(p.y)});
    low_x = std::min(low_x, p.x), high_x = std::max(high_x, p.x);
    low_y = std::min(low_y, p.y), high_y = std::max(high_y, p.y);
  }
  if (points.empty()) return;
  moment_x = std::clamp(moment_x, load * low_x, load * high_x);
  moment_y = std::clamp(moment_y, load * low_y, load * high_y);
  const double per_reach = reach > 0 ? 1 / reach : 0;
  for (size_t left = points.size(); left > 0;) {
    double K[6] = {};
    for (const BearingPoint& p : points) {
      if (!p.bears) continue;
      const double r[3] = {p.cosine, p.cosine * p.x * per_reach, p.cosine * p.y * per_reach};
      K[0] += r[0] * r[0], K[1] += r[1] * r[0], K[2] += r[2] * r[0];
      K[3] += r[1] * r[1], K[4] += r[2] * r[1], K[5] += r[2] * r[2];
    }
    const double b[3] = {load, moment_x * per_reach, moment_y * per_reach};
    double u[3], least = 0;
    detail::solve_stiffened(K, b, u);
    BearingPoint* worst = nullptr;
    for (BearingPoint& p : points) {
      p.force = p.bears ? p.cosine * (u[0] + (p.x * u[1] + p.y * u[2]) * per_reach) : 0;
      if (p.force < least) least = p.force, worst = &p;
    }
    if (!worst || least > -1e-9 * load) break;
    worst->bears = false, worst->force = 0, --left;
  }
  for (BearingPoint& p : points) p.force = std::max(p.force, 0.0);
}

}  // namespace truestep
