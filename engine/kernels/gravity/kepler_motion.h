// Motion of a body about a fixed centre of attraction, x'' = -mu x/|x|^3, by f and g functions in the
// universal variable s, ds = dt/r:
//   beta = 2 mu/r0 - v0^2,  G_k = s^k c_k(beta s^2),  eta = x0.v0,  zeta = mu - beta r0
//   dt = r0 G1 + eta G2 + mu G3,   r = r0 + eta G1 + zeta G2 (= dt's slope in s)
//   x = (1 - mu/r0 G2) x0 + (dt - mu G3) v0,   v = -mu G1/(r0 r) x0 + (1 - mu/r G2) v0
// (Stumpff 1962; Danby 1992, ch. 6.9; Rein & Tamayo 2015, eqs. 26 to 33.) Ellipses, parabolas and hyperbolas
// alike. The equation for dt is solved by Newton's method between bounds: it increases monotonically with s.
// Not covered: a straight fall into the centre.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep::gravity {

namespace kepler_detail {

/// c_0 to c_3 of Stumpff: c_k(x) = sum_n (-x)^n/(k + 2n)!.
struct Stumpff {
  double c0, c1, c2, c3;
};

inline Stumpff stumpff(double x) {
  // The argument is quartered until the series needs seven terms, then doubled back.
  int halvings = 0;
  while (std::abs(x) > 0.1) x *= 0.25, ++halvings;
  double c2 = 1, c3 = 1;  // relative to their values at x = 0
  for (int k = 16; k >= 4; k -= 2) {
    c2 = 1 - x * c2 / (k * (k - 1));
    c3 = 1 - x * c3 / ((k + 1) * k);
  }
  Stumpff c{0, 0, c2 / 2, c3 / 6};
  c.c1 = 1 - x * c.c3, c.c0 = 1 - x * c.c2;
  for (; halvings > 0; --halvings) {
    x *= 4;
    c.c3 = (c.c2 + c.c0 * c.c3) * 0.25;
    c.c2 = c.c1 * c.c1 * 0.5;
    c.c1 = c.c0 * c.c1;
    c.c0 = 2 * c.c0 * c.c0 - 1;
  }
  return c;
}

}  // namespace kepler_detail

/// Moves x (m) and v (m/s) by h (s) about a centre of strength mu (m^3/s^2) at the origin. mu = 0: straight
/// on.
inline void kepler_motion(Vec3& x, Vec3& v, double mu, double h) {
  const double r0 = norm(x);
  if (!(mu > 0) || !(r0 > 0)) {
    x += v * h;
    return;
  }
  const double beta = 2 * mu / r0 - norm2(v), eta = dot(x, v), zeta = mu - beta * r0;
  double left = h;
  if (beta > 0) {  // full revolutions change nothing
    const double turn = 6.283185307179586 * mu / (beta * std::sqrt(beta));
    left -= turn * std::nearbyint(h / turn);
  }
  double g1 = 0, g2 = 0, g3 = 0, r = r0;
  const auto evaluate = [&](double s) {
    const kepler_detail::Stumpff c = kepler_detail::stumpff(beta * s * s);
    g1 = c.c1 * s, g2 = c.c2 * s * s, g3 = c.c3 * s * s * s;
    r = r0 + eta * g1 + zeta * g2;
    return r0 * g1 + eta * g2 + mu * g3 - left;
  };
  // Bounds: the smallest possible distance, the pericentre q, is the smallest slope; s lies between 0 and
  // left/q.
  const double l2 = norm2(x) * norm2(v) - eta * eta, e2 = std::max(0.0, 1 - beta * l2 / (mu * mu));
  const double q = std::max(l2 / (mu * (1 + std::sqrt(e2))), 1e-14 * r0);
  double low = std::min(0.0, left / q), high = std::max(0.0, left / q);
  double s = left / r0 * (1 - 0.5 * eta * left / (r0 * r0));
  if (!(s > low && s < high)) s = 0.5 * (low + high);
  double last = high - low;
  for (int k = 0; k < 100; ++k) {
    const double fault = evaluate(s);
    // Far out along a hyperbola the numbers overflow: that is too far.
    const bool beyond = std::isfinite(fault) && std::isfinite(r) ? fault > 0 : s > 0;
    (beyond ? high : low) = s;
    double next = s - fault / r;
    // Along a hyperbola's exponentials Newton steps stay the same size: steps that do not shrink are replaced
    // by bisection.
    const bool creeps = std::abs(next - s) > 0.5 * std::abs(last) && std::abs(next - s) > 1e-8 * std::abs(s);
    if (creeps || !(next >= low && next <= high)) next = 0.5 * (low + high);
    last = next - s;
    const bool done = std::abs(next - s) <= 4e-16 * std::abs(next);
    s = next;
    if (done) break;
  }
  evaluate(s);
  const double f = -mu * g2 / r0, g = left - mu * g3, fdot = -mu * g1 / (r0 * r), gdot = -mu * g2 / r;
  const Vec3 x0 = x, v0 = v;
  x = x0 + (x0 * f + v0 * g), v = v0 + (x0 * fdot + v0 * gdot);
}

}  // namespace truestep::gravity
