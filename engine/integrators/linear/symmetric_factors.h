// Factors of M = I - c1 A1 - c2 A2 where A1 and A2 are accelerations' derivatives, W K with diagonal W
// (inverse masses) and symmetric K in blocks of 3 x 3: W^-1 M is symmetric and goes to L D L^T by blocks
// (math/solvers/block_ldlt.h), which on nets is some ten times as fast as a sparse LU of single numbers. Rows
// of inverse mass 0 are rows of the identity; their columns move to the right-hand side. There is no
// pivoting: factors of an indefinite matrix are accepted if they return a known solution.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/block_sparse.h"
#include "engine/math/solvers/block_ldlt.h"

namespace truestep {

class SymmetricFactors {
 public:
  /// Compressed columns of A1 and A2, whose entries must form whole blocks in a symmetric pattern; n is a
  /// multiple of 3.
  SymmetricFactors(size_t n, std::span<const int32_t> column_start, std::span<const int32_t> rows);

  /// `inverse_mass`: one number for three rows; `a2` may be null. False: singular, or in need of pivots.
  bool factor(const double* a1, const double* a2, double c1, double c2, std::span<const double> inverse_mass);
  /// M^-1 b in place, after a successful factorisation.
  void solve(double* b);

 private:
  bool returns_known_solution();

  // Entry (row, column) of M for a column of inverse mass 0.
  struct Held {
    uint32_t row, column;
    double value;
  };

  std::vector<uint32_t> place_;            // of every given entry among the values of `matrix_`
  std::vector<int32_t> rows_, column_of_;  // block row and column of every given entry
  std::vector<double> mass_, known_;       // mass_: 0 for rows of the identity
  std::vector<Held> held_;
  BlockSparse matrix_;
  BlockLdlt ldlt_;
};

}  // namespace truestep
