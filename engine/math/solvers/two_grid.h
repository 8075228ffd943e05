// Conjugate gradients for large symmetric positive definite systems of points in space, preconditioned by two
// grids: polynomials of the matrix scaled with its diagonal blocks on the fine one (Chebyshev's, on the upper
// part of the spectrum; Adams and others 2003, Journal of Computational Physics 188), and rigid motions of
// aggregates of neighbouring rows on the coarse one, whose system A_c = P^T A P is solved directly (Vanek,
// Mandel, Brezina 1996, Computing 56, without their smoothing of P). A row i of an aggregate with centre c
// moves as u + w x (x_i - c), so that the coarse grid represents the slow bending of a body. Sums run over
// fixed blocks of rows or over the rows of an aggregate: any number of threads gives the same bits.
#pragma once
#include <span>
#include <vector>

#include "engine/math/solvers/block_ldlt.h"
#include "engine/math/solvers/pcg.h"

namespace truestep {

class TwoGrid {
 public:
  /// Forms aggregates for a pattern with blocks of 3; does nothing if this pattern has been analysed already.
  void analyze(const BlockSparse& a);
  size_t aggregates() const { return begin_.empty() ? 0 : begin_.size() - 1; }
  /// Block products of the coarse factorisation, after analyze.
  double coarse_work() const { return coarse_solver_.work(); }

  /// As Pcg::solve. `places`: m, three per block row. Also reports negative curvature of the coarse matrix.
  Pcg::Result solve(const BlockSparse& a, std::span<const double> places, std::span<const double> b,
                    std::span<double> x, double tolerance, int max_iterations, const ThreadArena& arena);
  /// Another right-hand side for the matrix of the last solve.
  Pcg::Result solve_again(const BlockSparse& a, std::span<const double> b, std::span<double> x,
                          double tolerance, int max_iterations, const ThreadArena& arena);

 private:
  using Vector = std::vector<double, CacheLineAllocator<double>>;
  bool prepare(const BlockSparse& a, std::span<const double> places, const ThreadArena& arena);
  double largest_eigenvalue(const BlockSparse& a, const ThreadArena& arena);
  void smooth(const BlockSparse& a, const double* r, double* z, const ThreadArena& arena);
  void correct(const double* r, double* z, const ThreadArena& arena);
  void precondition(const BlockSparse& a, const double* r, double* z, const ThreadArena& arena);

  uint64_t stamp_ = 0;
  std::vector<uint32_t> aggregate_;      // of a row
  std::vector<uint32_t> begin_, rows_;   // rows of an aggregate
  std::vector<BlockSparse::Slot> slot_;  // per block: the coarse block of translations; the others follow
  BlockSparse coarse_;                   // two rows per aggregate: translation, rotation
  BlockLdlt coarse_solver_;
  double highest_ = 1;  // eigenvalue of D^-1 A
  Vector inverse_, arm_, free_, r_, z_, p_, q_, d_, s_, t_, sums_;
  std::vector<double> small_;
};

}  // namespace truestep
