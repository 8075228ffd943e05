// Conjugate gradients for symmetric positive definite block systems, preconditioned with the inverses of the
// diagonal blocks (Hestenes, Stiefel 1952; Saad 2003, "Iterative methods for sparse linear systems",
// algorithm 9.1). All sums run over fixed blocks of rows, so any number of threads gives the same bits.
// Negative curvature is reported, not hidden: the caller decides what an indefinite matrix means.
#pragma once
#include <span>
#include <vector>

#include "engine/math/block_sparse.h"

namespace truestep {

class Pcg {
 public:
  enum class Outcome : uint8_t { converged, out_of_iterations, negative_curvature };
  struct Result {
    Outcome outcome = Outcome::converged;
    int iterations = 0;
    double reduction = 0;  ///< preconditioned residual norm at the end over that at the start
  };

  /// x ~ A^-1 b, starting from 0, until the preconditioned residual norm has fallen to `tolerance` of its
  /// first value. Blocks of 1 or 3 rows (Error "bad_pattern" otherwise). Allocates when the size grows.
  Result solve(const BlockSparse& a, std::span<const double> b, std::span<double> x, double tolerance,
               int max_iterations, const ThreadArena& arena);
  /// Allocates what solving with this pattern needs.
  void reserve(const BlockSparse& a);

 private:
  using Vector = std::vector<double, CacheLineAllocator<double>>;
  Vector r_, z_, p_, q_, inverse_, sums_;
};

/// Inverse of a 3 x 3 matrix in packed columns; zero when it is singular.
void invert_block3(const double* a, double* inverse);

}  // namespace truestep
