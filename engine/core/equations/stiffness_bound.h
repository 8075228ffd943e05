// Interface of fields whose stiffness is bounded everywhere by a matrix without directions:
//   u^T (-df/dx - df/dv / h) u <= sum_ij B_ij u_i . u_j   for all u,
// B one number per pair of points, the same along x, y and z (of a spring k times the graph's Laplacian,
// whatever its direction). Fields with parts that may exceed it (sharp bends, air) leave those out: a method
// that uses B checks the forces after each move.
#pragma once
#include "engine/core/equations/force_field.h"

namespace truestep {

class StiffnessBound {
 public:
  virtual ~StiffnessBound() = default;
  /// Gives `out` the pattern of interacting points, in 1 x 1 blocks.
  virtual void bound_pattern(BlockSparse& out) const = 0;
  /// Overwrites the values of B (N/m) for steps of h (s).
  virtual void bound(const State& state, double h, BlockSparse& out) const = 0;
};

}  // namespace truestep
