// Solves A x = b for the systems that implicit methods make: conjugate gradients while they promise to be
// cheaper than a factorisation, of large bodies with two grids, else L D L^T with the cached order of the
// pattern; matrices that are not
// symmetric go to a sparse LU. The choice depends on the matrix and the arguments alone, never on timings or
// earlier solves, so it is part of the reproducible result.
#pragma once
#include <span>

#include "engine/math/solvers/block_ldlt.h"
#include "engine/math/solvers/pcg.h"
#include "engine/math/solvers/two_grid.h"

namespace truestep {

class BlockSolver {
 public:
  enum class Symmetry : uint8_t { symmetric, general };
  struct Request {
    double tolerance = 1e-10;  ///< relative reduction of the residual that is wanted
    /// Estimate of the condition number after scaling with the diagonal blocks.
    double condition = 1;
    Symmetry symmetry = Symmetry::symmetric;
    /// m, three a block row of three: where the rows are, for what large systems need of it; may be empty.
    std::span<const double> places = {};
  };
  enum class Method : uint8_t { conjugate_gradients, two_grids, ldlt, lu };
  struct Result {
    Method method = Method::conjugate_gradients;
    int iterations = 0;
    bool solved = true;  ///< false: the matrix is singular
    enum class Sign : uint8_t { positive, indefinite } sign = Sign::positive;  ///< as far as the method saw
  };

  Result solve(const BlockSparse& a, std::span<const double> b, std::span<double> x, const Request& request,
               const ThreadArena& arena);
  /// Sets aside what any later solve with this pattern may need.
  void reserve(const BlockSparse& a);
  /// Another right-hand side for the matrix of the last solve, which was symmetric and must not have changed;
  /// a factorisation is used again.
  void solve_again(const BlockSparse& a, std::span<const double> b, std::span<double> x, double tolerance,
                   const ThreadArena& arena);

 private:
  Method last_ = Method::ldlt;
  Pcg pcg_;
  TwoGrid two_grids_;
  BlockLdlt ldlt_;
};

}  // namespace truestep
