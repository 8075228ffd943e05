// Interactions within molecules: energy and forces of
//   a bond k/2 (r - L)^2,  an angle k/2 (theta - theta0)^2,  a dihedral k (1 + cos(n phi - delta))
// phi and its gradient after Blondel and Karplus 1996, eqs. 4 and 27: no singularity except at straight
// angles. If a direction is not defined (coincident atoms, a straight angle) the force is 0.
#pragma once
#include <cmath>

#include "engine/math/trig.h"
#include "engine/math/vec3.h"

namespace truestep::molecular {

struct BondForce {
  double energy;  ///< J
  Vec3 on_a;      ///< N; b gets the opposite
};
/// d = x_a - x_b.
inline BondForce bond(const Vec3& d, double stiffness, double length) {
  const double r = norm(d), stretch = r - length;
  return {0.5 * stiffness * stretch * stretch, r > 0 ? d * (-stiffness * stretch / r) : Vec3{}};
}

struct AngleForce {
  double energy;
  Vec3 on_a, on_c;  ///< b gets the opposite of their sum
};
/// u = x_a - x_b, v = x_c - x_b, theta between them.
inline AngleForce angle(const Vec3& u, const Vec3& v, double stiffness, double rest) {
  const Vec3 n = cross(u, v);
  const double area = norm(n), turn = trig::atan2(area, dot(u, v)) - rest;
  AngleForce f{0.5 * stiffness * turn * turn, {}, {}};
  if (!(area > 1e-10 * (norm2(u) + norm2(v)))) return f;
  // d theta / d a is perpendicular to u in the plane, 1 / |u| large, and opens the angle.
  const double slope = -stiffness * turn / area;
  f.on_a = cross(u, n) * (slope / norm2(u)), f.on_c = cross(n, v) * (slope / norm2(v));
  return f;
}

struct DihedralForce {
  double energy;
  Vec3 on_a, on_b, on_c, on_d;
};
/// f = x_a - x_b, g = x_b - x_c, h = x_d - x_c; phi = 0 when a and d are on the same side.
inline DihedralForce dihedral(const Vec3& f, const Vec3& g, const Vec3& h, double k, double n, double phase) {
  const Vec3 a = cross(f, g), b = cross(h, g);
  const double a2 = norm2(a), b2 = norm2(b), length = norm(g);
  if (!(a2 > 0) || !(b2 > 0)) return {k * (1 + trig::cos(phase)), {}, {}, {}, {}};
  const double phi = trig::atan2(dot(cross(b, a), g) / length, dot(a, b));
  const trig::SinCos turn = trig::sincos(n * phi - phase);
  const double slope = k * n * turn.sin;  // -dU/dphi
  const Vec3 da = a * (length / a2), db = b * (length / b2);
  const Vec3 shared = a * (dot(f, g) / (a2 * length)) - b * (dot(h, g) / (b2 * length));
  return {k * (1 + turn.cos), da * -slope, (da + shared) * slope, (shared + db) * -slope, db * slope};
}

}  // namespace truestep::molecular
