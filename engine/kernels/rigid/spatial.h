// Spatial (six-dimensional) vectors of rigid body mechanics in body coordinates: motions (w, v), forces (n,
// f), the inertias between them, and the rigid transform from a link's frame to its parent's.
//   velocity:  v_child = R^T (v + w x p),  w_child = R^T w
//   force:     f_parent = R f,             n_parent = R n + p x f_parent
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 2 and table 2.1; inertias in table 2.2
// and section 7.1. Vectors and matrices are values: nothing here allocates or branches.
#pragma once
#include "engine/math/quaternion.h"

namespace truestep::spatial {

/// Symmetric 3 x 3 matrix.
struct Symmetric {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  constexpr Vec3 operator*(const Vec3& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  constexpr Symmetric& operator+=(const Symmetric& b) {
    xx += b.xx, yy += b.yy, zz += b.zz, xy += b.xy, xz += b.xz, yz += b.yz;
    return *this;
  }
  constexpr Vec3 row(int i) const {
    return i == 0 ? Vec3{xx, xy, xz} : i == 1 ? Vec3{xy, yy, yz} : Vec3{xz, yz, zz};
  }
};

/// S - k u u^T.
constexpr Symmetric minus_outer(const Symmetric& s, const Vec3& u, double k) {
  const Vec3 w = u * k;
  return {s.xx - u.x * w.x, s.yy - u.y * w.y, s.zz - u.z * w.z,
          s.xy - u.x * w.y, s.xz - u.x * w.z, s.yz - u.y * w.z};
}
/// Determinant of S.
constexpr double determinant(const Symmetric& s) {
  return s.xx * (s.yy * s.zz - s.yz * s.yz) - s.xy * (s.xy * s.zz - s.yz * s.xz) +
         s.xz * (s.xy * s.yz - s.yy * s.xz);
}
/// Inverse of a positive definite S by its cofactors.
constexpr Symmetric inverse(const Symmetric& s) {
  const double d = 1 / determinant(s);
  return {d * (s.yy * s.zz - s.yz * s.yz), d * (s.xx * s.zz - s.xz * s.xz), d * (s.xx * s.yy - s.xy * s.xy),
          d * (s.xz * s.yz - s.xy * s.zz), d * (s.xy * s.yz - s.xz * s.yy), d * (s.xy * s.xz - s.xx * s.yz)};
}

/// 3 x 3 matrix by rows.
struct Matrix {
  Vec3 row[3];

  constexpr Vec3 operator*(const Vec3& v) const { return {dot(row[0], v), dot(row[1], v), dot(row[2], v)}; }
  /// Transposed times v.
  constexpr Vec3 transposed_times(const Vec3& v) const { return row[0] * v.x + row[1] * v.y + row[2] * v.z; }
};

/// R S R^T.
constexpr Symmetric rotated(const Rotation& r, const Symmetric& s) {
  const Vec3 a = s * r.row[0], b = s * r.row[1], c = s * r.row[2];
  return {dot(r.row[0], a), dot(r.row[1], b), dot(r.row[2], c),
          dot(r.row[1], a), dot(r.row[2], a), dot(r.row[2], b)};
}
/// R M R^T.
constexpr Matrix rotated(const Rotation& r, const Matrix& m) {
  const auto line = [&](const Vec3& of) {
    const Vec3 u = m.transposed_times(of);  // of^T M
    return Vec3{dot(u, r.row[0]), dot(u, r.row[1]), dot(u, r.row[2])};
  };
  return {{line(r.row[0]), line(r.row[1]), line(r.row[2])}};
}

/// Angular velocity, and velocity of the body's point at the frame's origin.
struct Motion {
  Vec3 w, v;
  constexpr Motion& operator+=(const Motion& b) {
    w += b.w, v += b.v;
    return *this;
  }
  friend constexpr Motion operator+(Motion a, const Motion& b) { return a += b; }
};
/// Moment about the frame's origin, and force.
struct Force {
  Vec3 n, f;
  constexpr Force& operator+=(const Force& b) {
    n += b.n, f += b.f;
    return *this;
  }
  friend constexpr Force operator+(Force a, const Force& b) { return a += b; }
  friend constexpr Force operator-(const Force& a, const Force& b) { return {a.n - b.n, a.f - b.f}; }
};
/// Power.
constexpr double dot(const Motion& m, const Force& f) {
  return truestep::dot(m.w, f.n) + truestep::dot(m.v, f.f);
}
/// a x b, the rate of change of a motion b that is fixed in a body moving with a (equation 2.31).
constexpr Motion cross(const Motion& a, const Motion& b) {
  return {truestep::cross(a.w, b.w), truestep::cross(a.w, b.v) + truestep::cross(a.v, b.w)};
}
/// a x* f, the same for a force (equation 2.32).
constexpr Force cross(const Motion& a, const Force& f) {
  return {truestep::cross(a.w, f.n) + truestep::cross(a.v, f.f), truestep::cross(a.w, f.f)};
}

/// Pose of a child's frame in its parent's: x_parent = R x + p.
struct Frame {
  Rotation R;
  Vec3 p;

  constexpr Motion into(const Motion& m) const {
    return {R.apply_inverse(m.w), R.apply_inverse(m.v + truestep::cross(m.w, p))};
  }
  constexpr Force out(const Force& g) const {
    const Vec3 f = R.apply(g.f);
    return {R.apply(g.n) + truestep::cross(p, f), f};
  }
};

/// Inertia of one rigid body: mass (kg), mass times centre (kg m), inertia about the frame's origin (kg m^2).
struct Inertia {
  double m = 0;
  Vec3 h;
  Symmetric I;
  constexpr Force operator*(const Motion& u) const {
    return {I * u.w + truestep::cross(h, u.v), u.v * m - truestep::cross(h, u.w)};
  }
};

/// Symmetric 6 x 6 matrix [A B; B^T C]: the inertia of a link together with everything attached to it.
struct ArticulatedInertia {
  Symmetric A;
  Matrix B;
  Symmetric C;

  constexpr Force operator*(const Motion& u) const {
    return {A * u.w + B * u.v, B.transposed_times(u.w) + C * u.v};
  }
  constexpr ArticulatedInertia& operator+=(const ArticulatedInertia& o) {
    A += o.A, C += o.C;
    for (int i = 0; i < 3; ++i) B.row[i] += o.B.row[i];
    return *this;
  }
};
constexpr ArticulatedInertia articulated(const Inertia& b) {
  return {b.I, {{{0, -b.h.z, b.h.y}, {b.h.z, 0, -b.h.x}, {-b.h.y, b.h.x, 0}}}, {b.m, b.m, b.m, 0, 0, 0}};
}
/// The same inertia expressed in the parent's frame:
///   C' = R C R^T,  B' = R B R^T + [p] C',  A' = R A R^T - R B R^T [p] + [p] B'^T.
constexpr ArticulatedInertia out(const Frame& x, const ArticulatedInertia& a) {
  ArticulatedInertia o{rotated(x.R, a.A), rotated(x.R, a.B), rotated(x.R, a.C)};
  const Vec3& p = x.p;
  // Row i of M [p] is row_i x p.
  const Vec3 b0 = truestep::cross(o.B.row[0], p), b1 = truestep::cross(o.B.row[1], p),
             b2 = truestep::cross(o.B.row[2], p);
  // Column j of [p] C is p x column j of C.
  const Vec3 c0 = truestep::cross(p, o.C.row(0)), c1 = truestep::cross(p, o.C.row(1)),
             c2 = truestep::cross(p, o.C.row(2));
  o.B.row[0] += {c0.x, c1.x, c2.x}, o.B.row[1] += {c0.y, c1.y, c2.y}, o.B.row[2] += {c0.z, c1.z, c2.z};
  // Column j of [p] B'^T is p x row j of B'.
  const Vec3 z0 = truestep::cross(p, o.B.row[0]), z1 = truestep::cross(p, o.B.row[1]),
             z2 = truestep::cross(p, o.B.row[2]);
  o.A += Symmetric{z0.x - b0.x, z1.y - b1.y, z2.z - b2.z, z1.x - b0.y, z2.x - b0.z, z2.y - b1.z};
  return o;
}

}  // namespace truestep::spatial
