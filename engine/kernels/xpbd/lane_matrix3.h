// Vectors of three and 3 x 3 matrices of lanes: several small systems side by side. Matrices are row by row,
// m[3 r + c].
#pragma once
#include "engine/math/wide.h"

namespace truestep::xpbd {

template <class T>
struct LaneVec {
  Wide<T> x, y, z;

  static LaneVec zero() { return {Wide<T>::zero(), Wide<T>::zero(), Wide<T>::zero()}; }
  friend LaneVec operator+(const LaneVec& a, const LaneVec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend LaneVec operator-(const LaneVec& a, const LaneVec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend LaneVec operator*(const LaneVec& a, const Wide<T>& s) { return {a.x * s, a.y * s, a.z * s}; }
  /// Component by component.
  friend LaneVec scaled(const LaneVec& a, const LaneVec& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  friend LaneVec cross(const LaneVec& a, const LaneVec& b) {
    return {nmadd(a.z, b.y, a.y * b.z), nmadd(a.x, b.z, a.z * b.x), nmadd(a.y, b.x, a.x * b.y)};
  }
};

template <class T>
struct LaneMat {
  Wide<T> m[9];

  static LaneMat zero() {
    LaneMat r;
    for (auto& x : r.m) x = Wide<T>::zero();
    return r;
  }
  /// s I + [v], where [v] a = v x a.
  static LaneMat turn(const Wide<T>& s, const LaneVec<T>& v) {
    return {{s, -v.z, v.y, v.z, s, -v.x, -v.y, v.x, s}};
  }
  friend LaneVec<T> operator*(const LaneMat& a, const LaneVec<T>& v) {
    const auto row = [&](int r) {
      return madd(a.m[3 * r + 2], v.z, madd(a.m[3 * r + 1], v.y, a.m[3 * r] * v.x));
    };
    return {row(0), row(1), row(2)};
  }
  /// A^T v.
  friend LaneVec<T> transposed_times(const LaneMat& a, const LaneVec<T>& v) {
    const auto column = [&](int c) { return madd(a.m[6 + c], v.z, madd(a.m[3 + c], v.y, a.m[c] * v.x)); };
    return {column(0), column(1), column(2)};
  }
  friend LaneMat operator*(const LaneMat& a, const LaneMat& b) {
    LaneMat out;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        out.m[3 * r + c] =
            madd(a.m[3 * r + 2], b.m[6 + c], madd(a.m[3 * r + 1], b.m[3 + c], a.m[3 * r] * b.m[c]));
      }
    }
    return out;
  }
  /// A B^T.
  friend LaneMat times_transposed(const LaneMat& a, const LaneMat& b) {
    LaneMat out;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        out.m[3 * r + c] = madd(a.m[3 * r + 2], b.m[3 * c + 2],
                                madd(a.m[3 * r + 1], b.m[3 * c + 1], a.m[3 * r] * b.m[3 * c]));
      }
    }
    return out;
  }
  /// A^T B.
  friend LaneMat transposed_times(const LaneMat& a, const LaneMat& b) {
    LaneMat out;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        out.m[3 * r + c] = madd(a.m[6 + r], b.m[6 + c], madd(a.m[3 + r], b.m[3 + c], a.m[r] * b.m[c]));
      }
    }
    return out;
  }
  /// A diag(d).
  friend LaneMat times_diagonal(const LaneMat& a, const LaneVec<T>& d) {
    LaneMat out;
    for (int r = 0; r < 3; ++r) {
      out.m[3 * r] = a.m[3 * r] * d.x, out.m[3 * r + 1] = a.m[3 * r + 1] * d.y,
                out.m[3 * r + 2] = a.m[3 * r + 2] * d.z;
    }
    return out;
  }
  friend LaneMat operator*(const LaneMat& a, const Wide<T>& s) {
    LaneMat out;
    for (int k = 0; k < 9; ++k) out.m[k] = a.m[k] * s;
    return out;
  }
  friend LaneMat operator-(const LaneMat& a, const LaneMat& b) {
    LaneMat out;
    for (int k = 0; k < 9; ++k) out.m[k] = a.m[k] - b.m[k];
    return out;
  }
};

/// A symmetric matrix: xx, xy, xz, yy, yz, zz.
template <class T>
struct LaneSym {
  Wide<T> xx, xy, xz, yy, yz, zz;

  static LaneSym zero() {
    const auto z = Wide<T>::zero();
    return {z, z, z, z, z, z};
  }
  static LaneSym diagonal(const LaneVec<T>& d) {
    const auto z = Wide<T>::zero();
    return {d.x, z, z, d.y, z, d.z};
  }
  friend LaneVec<T> operator*(const LaneSym& a, const LaneVec<T>& v) {
    return {madd(a.xz, v.z, madd(a.xy, v.y, a.xx * v.x)), madd(a.yz, v.z, madd(a.yy, v.y, a.xy * v.x)),
            madd(a.zz, v.z, madd(a.yz, v.y, a.xz * v.x))};
  }
  friend LaneMat<T> operator*(const LaneMat<T>& a, const LaneSym& s) {
    LaneMat<T> out;
    for (int r = 0; r < 3; ++r) {
      const LaneVec<T> row = s * LaneVec<T>{a.m[3 * r], a.m[3 * r + 1], a.m[3 * r + 2]};
      out.m[3 * r] = row.x, out.m[3 * r + 1] = row.y, out.m[3 * r + 2] = row.z;
    }
    return out;
  }
  /// Adds `sign` times A B^T, which must be symmetric.
  void add(T sign, const LaneMat<T>& a, const LaneMat<T>& b) {
    const Wide<T> s(sign);
    const auto entry = [&](int r, int c) {
      return s * madd(a.m[3 * r + 2], b.m[3 * c + 2],
                      madd(a.m[3 * r + 1], b.m[3 * c + 1], a.m[3 * r] * b.m[3 * c]));
    };
    xx += entry(0, 0), xy += entry(0, 1), xz += entry(0, 2);
    yy += entry(1, 1), yz += entry(1, 2), zz += entry(2, 2);
  }
  /// By elimination; zero if a pivot is not positive.
  friend LaneSym inverse(const LaneSym& a) {
    // L D L^T with unit lower triangular L, then L^-T D^-1 L^-1.
    const Wide<T> one(T(1)), zero = Wide<T>::zero();
    const Wide<T> d0 = where_positive(a.xx, one / a.xx, zero);
    const Wide<T> l10 = a.xy * d0, l20 = a.xz * d0;
    const Wide<T> p1 = nmadd(l10, a.xy, a.yy), d1 = where_positive(p1, one / p1, zero);
    const Wide<T> e21 = nmadd(l20, a.xy, a.yz), l21 = e21 * d1;
    const Wide<T> p2 = nmadd(l21, e21, nmadd(l20, a.xz, a.zz)), d2 = where_positive(p2, one / p2, zero);
    // Rows of L^-1: (1, 0, 0), (-l10, 1, 0), (m, -l21, 1).
    const Wide<T> m = nmadd(l21, -l10, -l20);
    LaneSym out;
    out.zz = d2, out.yz = -(l21 * d2), out.xz = m * d2;
    out.yy = nmadd(l21, out.yz, d1), out.xy = nmadd(l21, out.xz, -(l10 * d1));
    out.xx = madd(m, out.xz, madd(l10, l10 * d1, d0));
    return out;
  }
};

/// Matrix of a unit quaternion (w, x, y, z): body to world.
template <class T>
LaneMat<T> lane_rotation(const Wide<T> q[4]) {
  const Wide<T> one(T(1)), two(T(2));
  const Wide<T>&w = q[0], &x = q[1], &y = q[2], &z = q[3];
  return {{nmadd(two, madd(y, y, z * z), one), two * nmadd(w, z, x * y), two * madd(w, y, x * z),
           two * madd(w, z, x * y), nmadd(two, madd(x, x, z * z), one), two * nmadd(w, x, y * z),
           two * nmadd(w, y, x * z), two * madd(w, x, y * z), nmadd(two, madd(x, x, y * y), one)}};
}

}  // namespace truestep::xpbd
