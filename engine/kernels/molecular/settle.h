// Rigid molecules of three atoms, two of them alike (water), solved in closed form: S. Miyamoto, P. Kollman,
// "SETTLE", J. Comput. Chem. 13 (1992) 952. Positions are restored to a triangle with the right sides by
// forces along the sides it had at the step's start (their eqs. 15 to 18); velocities lose the components
// that would change a side.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep::molecular {

/// Positions or velocities of O, H, H.
using Triangle = std::array<Vec3, 3>;

struct WaterShape {
  double oxygen, hydrogen;  ///< kg
  double oh, hh;            ///< m

  double mass() const { return oxygen + 2 * hydrogen; }
  double height() const { return std::sqrt(oh * oh - 0.25 * hh * hh); }
};

/// `old` has the right sides; `moved` is its position after a step without constraint forces.
inline Triangle settle_places(const WaterShape& w, const Triangle& old, const Triangle& moved) {
  const double ra = 2 * w.hydrogen * w.height() / w.mass(), rb = w.height() - ra, rc = 0.5 * w.hh;
  const Vec3 center = (moved[0] * w.oxygen + (moved[1] + moved[2]) * w.hydrogen) / w.mass();
  const Vec3 b0 = old[1] - old[0], c0 = old[2] - old[0];
  const Vec3 a1 = moved[0] - center, b1 = moved[1] - center, c1 = moved[2] - center;
  // z is normal to the old plane, and the new oxygen lies in the plane of y and z.
  const Vec3 ez = normalized(cross(b0, c0)), ex = normalized(cross(a1, ez)), ey = cross(ez, ex);
  const auto root = [](double square) { return std::sqrt(std::max(0.0, square)); };
  // Rotations about x and y set the heights above the old plane, which forces in it do not change.
  const double sin_phi = std::clamp(dot(ez, a1) / ra, -1.0, 1.0), cos_phi = root(1 - sin_phi * sin_phi);
  const double tilt = 2 * rc * cos_phi;
  const double sin_psi = tilt > 0 ? std::clamp(dot(ez, b1 - c1) / tilt, -1.0, 1.0) : 0.0;
  const double cos_psi = root(1 - sin_psi * sin_psi);
  const double ya = ra * cos_phi, xb = -rc * cos_psi, lift = rc * sin_psi * sin_phi;
  const double yb = -rb * cos_phi - lift, yc = -rb * cos_phi + lift;
  // The rotation about z that conserves the angular momentum of the forces along the old sides.
  const double xb0 = dot(ex, b0), yb0 = dot(ey, b0), xc0 = dot(ex, c0), yc0 = dot(ey, c0);
  const double alpha = xb * (xb0 - xc0) + yb0 * yb + yc0 * yc;
  const double beta = xb * (yc0 - yb0) + xb0 * yb + xc0 * yc;
  const double gamma = xb0 * dot(ey, b1) - dot(ex, b1) * yb0 + xc0 * dot(ey, c1) - dot(ex, c1) * yc0;
  const double size2 = alpha * alpha + beta * beta;
  const double s =
      size2 > 0 ? std::clamp((alpha * gamma - beta * root(size2 - gamma * gamma)) / size2, -1.0, 1.0) : 0.0;
  const double c = root(1 - s * s);
  const auto place = [&](double x, double y, double z) { return center + ex * x + ey * y + ez * z; };
  return {place(-ya * s, ya * c, dot(ez, a1)), place(xb * c - yb * s, xb * s + yb * c, dot(ez, b1)),
          place(-xb * c - yc * s, -xb * s + yc * c, dot(ez, c1))};
}

/// Removes velocity components along the sides: v_i + sum over sides of t e / m_i with (v_i - v_j) . e = 0.
inline Triangle settle_velocities(const WaterShape& w, const Triangle& x, const Triangle& v) {
  constexpr int kEnds[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  const double inverse[3] = {1 / w.oxygen, 1 / w.hydrogen, 1 / w.hydrogen};
  Vec3 e[3];
  double m[3][3], r[3];
  for (int k = 0; k < 3; ++k) e[k] = normalized(x[kEnds[k][0]] - x[kEnds[k][1]]);
  for (int k = 0; k < 3; ++k) {
    const auto [i, j] = kEnds[k];
    r[k] = -dot(v[i] - v[j], e[k]);
    for (int l = 0; l < 3; ++l) {
      // Change of v_i - v_j along e_k per unit impulse along side l: + at its first end, - at its second.
      const double at_i = (kEnds[l][0] == i ? 1 : kEnds[l][1] == i ? -1 : 0) * inverse[i];
      const double at_j = (kEnds[l][0] == j ? 1 : kEnds[l][1] == j ? -1 : 0) * inverse[j];
      m[k][l] = (at_i - at_j) * dot(e[k], e[l]);
    }
  }
  const Vec3 p{m[0][0], m[1][0], m[2][0]}, q{m[0][1], m[1][1], m[2][1]}, s{m[0][2], m[1][2], m[2][2]};
  const Vec3 right{r[0], r[1], r[2]};
  const double det = dot(p, cross(q, s));
  if (!(std::abs(det) > 0)) return v;
  const double t[3] = {dot(right, cross(q, s)) / det, dot(p, cross(right, s)) / det,
                       dot(p, cross(q, right)) / det};
  Triangle out = v;
  for (int k = 0; k < 3; ++k) {
    const auto [i, j] = kEnds[k];
    out[i] += e[k] * (t[k] * inverse[i]), out[j] -= e[k] * (t[k] * inverse[j]);
  }
  return out;
}

}  // namespace truestep::molecular
