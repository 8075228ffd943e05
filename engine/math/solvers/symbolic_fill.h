// The cost of a sparse factorisation, from the pattern alone: nonzeros of every column of the Cholesky factor
// of a matrix with the pattern of A + A^T, eliminated in Eigen's approximate minimum degree order. For LU
// with diagonal pivots L and U^T have that pattern, so that a factorisation takes sum c_j^2 multiplications
// and a solve 2 sum c_j. Row subtrees of the elimination tree: Davis 2006, "Direct Methods for Sparse Linear
// Systems", section 4.4; time and memory are those of the factor's nonzeros and of the pattern.
#pragma once
#include "engine/math/solvers/reordering.h"

namespace truestep {

struct FactorWork {
  double factor = 0, solve = 0;  ///< multiplications
};

FactorWork symbolic_factor_work(const ColumnPattern& a);

}  // namespace truestep
