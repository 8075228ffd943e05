// 3 x 3 matrices, row by row: m[3 r + c]. The same index is used when a matrix is treated as nine numbers, as
// in derivatives with respect to matrices.
#pragma once
#include <array>

#include "engine/math/vec3.h"

namespace truestep {

struct Mat3 {
  std::array<double, 9> m{};

  static constexpr Mat3 diagonal(double a, double b, double c) { return {{a, 0, 0, 0, b, 0, 0, 0, c}}; }
  static constexpr Mat3 identity() { return diagonal(1, 1, 1); }
  constexpr double& operator()(size_t r, size_t c) { return m[3 * r + c]; }
  constexpr double operator()(size_t r, size_t c) const { return m[3 * r + c]; }
  constexpr Vec3 row(size_t r) const { return {m[3 * r], m[3 * r + 1], m[3 * r + 2]}; }
  constexpr Vec3 column(size_t c) const { return {m[c], m[3 + c], m[6 + c]}; }

  friend constexpr Mat3 operator+(Mat3 a, const Mat3& b) {
    for (size_t k = 0; k < 9; ++k) a.m[k] += b.m[k];
    return a;
  }
  friend constexpr Mat3 operator-(Mat3 a, const Mat3& b) {
    for (size_t k = 0; k < 9; ++k) a.m[k] -= b.m[k];
    return a;
  }
  friend constexpr Mat3 operator*(double s, Mat3 a) {
    for (size_t k = 0; k < 9; ++k) a.m[k] *= s;
    return a;
  }
  friend constexpr Mat3 operator*(const Mat3& a, const Mat3& b) {
    Mat3 out;
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 3; ++c) out(r, c) = a(r, 0) * b(0, c) + a(r, 1) * b(1, c) + a(r, 2) * b(2, c);
    }
    return out;
  }
  friend constexpr Vec3 operator*(const Mat3& a, const Vec3& v) {
    return {dot(a.row(0), v), dot(a.row(1), v), dot(a.row(2), v)};
  }
};

constexpr Mat3 transposed(const Mat3& a) {
  return {{a.m[0], a.m[3], a.m[6], a.m[1], a.m[4], a.m[7], a.m[2], a.m[5], a.m[8]}};
}
constexpr double trace(const Mat3& a) {
  return a.m[0] + a.m[4] + a.m[8];
}
/// Sum of elementwise products.
constexpr double inner(const Mat3& a, const Mat3& b) {
  double s = 0;
  for (size_t k = 0; k < 9; ++k) s += a.m[k] * b.m[k];
  return s;
}
constexpr double determinant(const Mat3& a) {
  return dot(a.row(0), cross(a.row(1), a.row(2)));
}
/// d det / dA: det A times the transposed inverse, if that exists.
constexpr Mat3 cofactor(const Mat3& a) {
  const Vec3 x = cross(a.row(1), a.row(2)), y = cross(a.row(2), a.row(0)), z = cross(a.row(0), a.row(1));
  return {{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}};
}
/// det A must differ from 0.
constexpr Mat3 inverse(const Mat3& a) {
  return (1 / determinant(a)) * transposed(cofactor(a));
}

}  // namespace truestep
