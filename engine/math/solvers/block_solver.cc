#include "engine/math/solvers/block_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "engine/math/solvers/sparse/sparse_lu.h"
#include "engine/math/trig.h"

namespace truestep {

namespace {
// Measured nanoseconds per stored block of one iteration, and per product of blocks of a factorisation.
constexpr double kIterationCost = 9, kFactorCost = 13;
// Fewer iterations than this need no estimate, and no analysis of the pattern.
constexpr double kAlwaysIterate = 60;
// Two grids: rows from which they are considered, iterations for a reduction by e, products with the matrix
// per iteration and in the preparation.
constexpr size_t kLarge = 12'000;
constexpr double kTwoGridIterations = 1.6, kProducts = 7, kPreparation = 60;

bool is_large(const BlockSparse& a) {
  return a.block_size() == 3 && a.block_rows() >= kLarge;
}

// A matrix of blocks as compressed columns of numbers, rows ascending.
struct CompressedColumns {
  explicit CompressedColumns(const BlockSparse& a)
      : start(a.size() + 1), rows(a.values().size()), values(rows.size()) {
    const size_t b = a.block_size();
    for (BlockSparse::Slot s = 0; s < a.blocks(); ++s) {
      for (size_t c = 0; c < b; ++c) start[a.column(s) * b + c + 1] += static_cast<int>(b);
    }
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<int> next(start.begin(), start.end() - 1);
    for (size_t i = 0; i < a.block_rows(); ++i) {
      for (BlockSparse::Slot s = a.row_begin(i); s < a.row_begin(i + 1); ++s) {
        for (size_t k = 0; k < b * b; ++k) {
          const auto at = static_cast<size_t>(next[a.column(s) * b + k / b]++);
          rows[at] = static_cast<int>(i * b + k % b), values[at] = a.block(s)[k];
        }
      }
    }
  }
  std::vector<int> start, rows;
  std::vector<double> values;
};
}  // namespace

void BlockSolver::reserve(const BlockSparse& a) {
  ldlt_.analyze(a);
  pcg_.reserve(a);
  if (is_large(a)) two_grids_.analyze(a);
}

BlockSolver::Result BlockSolver::solve(const BlockSparse& a, std::span<const double> b, std::span<double> x,
                                       const Request& request, const ThreadArena& arena) {
  if (request.symmetry == Symmetry::general) {
    const CompressedColumns c(a);
    const auto lu = make_sparse_lu<double>();
    lu->analyse(static_cast<int>(a.size()), c.start.data(), c.rows.data());
    if (!lu->factor(c.values.data())) return {Method::lu, 0, false};
    std::ranges::copy(b, x.begin());
    lu->solve(x.data());
    return {Method::lu, 0, true};
  }
  // Chebyshev's bound on the iterations: sqrt(condition) ln(2 / tolerance) / 2.
  const double expected =
      std::max(1.0, -0.5 * std::sqrt(std::max(1.0, request.condition)) * trig::log(0.5 * request.tolerance));
  bool iterate = expected <= kAlwaysIterate;
  if (!iterate) {
    ldlt_.analyze(a);
    iterate = expected * kIterationCost * double(a.blocks()) < kFactorCost * ldlt_.work();
  }
  int spent = 0;
  if (!(expected <= kAlwaysIterate) && is_large(a) && !request.places.empty()) {
    two_grids_.analyze(a);
    const double needed = -kTwoGridIterations * trig::log(request.tolerance);
    const double cost = (needed * kProducts + kPreparation) * kIterationCost * double(a.blocks()) +
                        kFactorCost * two_grids_.coarse_work();
    if (cost < std::min(expected * kIterationCost * double(a.blocks()), kFactorCost * ldlt_.work())) {
      const int limit = static_cast<int>(4 * needed + 20);
      const Pcg::Result r = two_grids_.solve(a, request.places, b, x, request.tolerance, limit, arena);
      last_ = Method::two_grids;
      if (r.outcome == Pcg::Outcome::converged) return {last_, r.iterations, true};
      spent = r.iterations, iterate = false;
    }
  }
  if (iterate) {
    const int limit = static_cast<int>(std::min(2 * expected + 20, 1e5));
    const Pcg::Result r = pcg_.solve(a, b, x, request.tolerance, limit, arena);
    last_ = Method::conjugate_gradients;
    if (r.outcome == Pcg::Outcome::converged) return {last_, r.iterations, true};
    spent = r.iterations;
  }
  last_ = Method::ldlt;
  const BlockLdlt::Outcome outcome = ldlt_.factorize(a);
  if (outcome == BlockLdlt::Outcome::singular) return {Method::ldlt, spent, false};
  ldlt_.solve(b, x);
  return {
      Method::ldlt, spent, true,
      outcome == BlockLdlt::Outcome::positive_definite ? Result::Sign::positive : Result::Sign::indefinite};
}

void BlockSolver::solve_again(const BlockSparse& a, std::span<const double> b, std::span<double> x,
                              double tolerance, const ThreadArena& arena) {
  if (last_ == Method::ldlt) {
    ldlt_.solve(b, x);
  } else if (last_ == Method::two_grids) {
    two_grids_.solve_again(a, b, x, tolerance, 1000, arena);
  } else {
    pcg_.solve(a, b, x, tolerance, 1000, arena);
  }
}

}  // namespace truestep
