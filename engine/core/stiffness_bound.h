// What a field can do whose forces stiffen nowhere beyond a matrix that knows no directions:
//   u^T (-df/dx - df/dv / h) u <= sum_ij B_ij u_i . u_j   for all u,
// B one number per pair of points, the same along x, y and z (of a spring k times the graph's Laplacian,
// whatever its direction). Fields with parts that may exceed it (sharp bends, air) leave those out: a method
// that uses B looks at the forces after each move.
#pragma once
#include "engine/core/force_field.h"

namespace truestep {

class StiffnessBound {
 public:
  virtual ~StiffnessBound() = default;
  /// Gives `out` the pattern of points that act on each other, blocks of one number.
  virtual void bound_pattern(BlockSparse& out) const = 0;
  /// Overwrites the values of B (N/m) for steps of h (s).
  virtual void bound(const State& state, double h, BlockSparse& out) const = 0;
};

}  // namespace truestep
