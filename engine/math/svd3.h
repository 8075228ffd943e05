// A = U diag(s) V^T of a 3 x 3 matrix with rotations U and V: s[0] >= s[1] >= |s[2]|, and s[2] has the sign
// of det A, so that a mirrored A is a rotation away from the plane that it crossed (Irving, Teran, Fedkiw
// 2004, "Invertible finite elements"). One-sided Jacobi rotations (Golub, Van Loan 2013, section 8.6.3) with
// square roots only: the same bits everywhere. Small singular values are as accurate as the large ones.
#pragma once
#include "engine/math/mat3.h"

namespace truestep {

struct Svd3 {
  Mat3 u, v;
  std::array<double, 3> s;
};
Svd3 svd3(const Mat3& a);

/// Values (not sorted) and unit vectors (columns) of a symmetric matrix, by cyclic Jacobi rotations.
struct Eigen3 {
  std::array<double, 3> values;
  Mat3 vectors;
};
Eigen3 eigen3(const Mat3& symmetric);

}  // namespace truestep
