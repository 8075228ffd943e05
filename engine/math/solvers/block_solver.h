// Solves A x = b for the systems of implicit methods: conjugate gradients while they promise to be cheaper
// than a factorisation (for large bodies with two grids), otherwise L D L^T with the cached ordering of the
// pattern; asymmetric matrices go to a sparse LU. The choice depends only on the matrix and the arguments,
// never on timings or earlier solves, so it is part of the reproducible result.
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
    double tolerance = 1e-10;  ///< desired relative reduction of the residual
    /// Estimate of the condition number after scaling with the diagonal blocks.
    double condition = 1;
    Symmetry symmetry = Symmetry::symmetric;
    /// m, three per block row of three: positions of the rows, used by large systems; may be empty.
    std::span<const double> places = {};
  };
  enum class Method : uint8_t { conjugate_gradients, two_grids, ldlt, lu };
  struct Result {
    Method method = Method::conjugate_gradients;
    int iterations = 0;
    bool solved = true;  ///< false: the matrix is singular
    enum class Sign : uint8_t {
      positive,
      indefinite
    } sign = Sign::positive;  ///< as far as the method
                              ///< noticed
  };

  Result solve(const BlockSparse& a, std::span<const double> b, std::span<double> x, const Request& request,
               const ThreadArena& arena);
  /// Reserves whatever any later solve with this pattern may need.
  void reserve(const BlockSparse& a);
  /// Another right-hand side for the matrix of the last solve, which was symmetric and must not have changed;
  /// reuses a factorisation.
  void solve_again(const BlockSparse& a, std::span<const double> b, std::span<double> x, double tolerance,
                   const ThreadArena& arena);

 private:
  Method last_ = Method::ldlt;
  Pcg pcg_;
  TwoGrid two_grids_;
  BlockLdlt ldlt_;
};

}  // namespace truestep
