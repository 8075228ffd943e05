// Symmetric block tridiagonal systems of 3 x 3 blocks, A x = b with positive definite A, by block elimination
// in O(n):  D_0 = A_00,  D_j = A_jj - B_j^T D_{j-1}^-1 B_j,  B_j = A_{j-1,j}  (Golub, Van Loan, section 4.5).
#pragma once
#include <span>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

/// A symmetric 3 x 3 matrix by rows.
struct Block3 {
  Vec3 row[3];
  Vec3 operator*(const Vec3& v) const { return {dot(row[0], v), dot(row[1], v), dot(row[2], v)}; }
};

/// s + t (1 - u u^T) for a unit vector u.
inline Block3 across(double s, double t, const Vec3& u) {
  return {{{s + t * (1 - u.x * u.x), -t * u.x * u.y, -t * u.x * u.z},
           {-t * u.y * u.x, s + t * (1 - u.y * u.y), -t * u.y * u.z},
           {-t * u.z * u.x, -t * u.z * u.y, s + t * (1 - u.z * u.z)}}};
}

/// Inverse by cofactors, the cross products of the rows.
inline Block3 inverse(const Block3& a) {
  const Vec3 x = cross(a.row[1], a.row[2]), y = cross(a.row[2], a.row[0]), z = cross(a.row[0], a.row[1]);
  const double d = 1 / dot(a.row[0], x);
  return {{Vec3{x.x, y.x, z.x} * d, Vec3{x.y, y.y, z.y} * d, Vec3{x.z, y.z, z.z} * d}};
}

class BlockTridiagonal {
 public:
  void resize(size_t n) { diagonal.resize(n), above.resize(n), inverse_.resize(n); }
  /// A_jj, and A_{j-1,j} for j >= 1; all symmetric.
  std::vector<Block3> diagonal, above;

  /// Factorizes the matrix; solve needs it.
  void factor() {
    for (size_t j = 0; j < diagonal.size(); ++j) {
      Block3 d = diagonal[j];
      if (j > 0) {
        const Block3 &b = above[j], &w = inverse_[j - 1];
        for (int r = 0; r < 3; ++r) {
          // Row r of B W B for symmetric blocks B and W.
          d.row[r] -= b * (w * b.row[r]);
        }
      }
      inverse_[j] = inverse(d);
    }
  }
  /// Replaces b by x.
  void solve(std::span<Vec3> b) const {
    for (size_t j = 1; j < b.size(); ++j) b[j] -= above[j] * (inverse_[j - 1] * b[j - 1]);
    for (size_t j = b.size(); j-- > 0;) {
      if (j + 1 < b.size()) b[j] -= above[j + 1] * b[j + 1];
      b[j] = inverse_[j] * b[j];
    }
  }

 private:
  std::vector<Block3> inverse_;
};

}  // namespace truestep
