// 4 x 4 single-precision matrices in OpenGL's column-major order, only what a camera and a light need.
#pragma once
#include <array>

#include "engine/math/vec3.h"

namespace truestep::picture {

struct Mat4 {
  std::array<float, 16> m{};  ///< column-major: element (row, column) is m[4 column + row]

  float& at(int row, int column) { return m[4 * column + row]; }
  float at(int row, int column) const { return m[4 * column + row]; }
};

inline Mat4 operator*(const Mat4& a, const Mat4& b) {
  Mat4 c;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) c.at(i, j) += a.at(i, k) * b.at(k, j);
  return c;
}

/// Rows `x`, `y`, `z` (orthonormal) and origin `o`: p -> (x.(p-o), y.(p-o), z.(p-o), 1).
inline Mat4 to_basis(const Vec3& x, const Vec3& y, const Vec3& z, const Vec3& o) {
  Mat4 r;
  const Vec3 rows[3] = {x, y, z};
  for (int i = 0; i < 3; ++i) {
    r.at(i, 0) = static_cast<float>(rows[i].x);
    r.at(i, 1) = static_cast<float>(rows[i].y);
    r.at(i, 2) = static_cast<float>(rows[i].z);
    r.at(i, 3) = static_cast<float>(-dot(rows[i], o));
  }
  r.at(3, 3) = 1;
  return r;
}

}  // namespace truestep::picture
