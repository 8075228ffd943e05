// Multigrid behind the interface of all lattice solvers: the given values of Dirichlet nodes are moved to the
// right-hand side before and restored after.
#include <algorithm>

#include "engine/lattice/solvers/multigrid.h"

namespace truestep::lattice {

MultigridSolver::MultigridSolver(const Lattice& finest, Multigrid<double>::Discretise discretise)
    : lattice_(finest), discretise_(std::move(discretise)), fine_(discretise_(finest)) {
  for (size_t i = 0; i < finest.nodes(); ++i) {
    if (finest.fixed(finest.place(i))) fixed_.push_back(static_cast<uint32_t>(i));
  }
  given_.resize(finest.nodes()), moved_.resize(finest.nodes()), x_.resize(finest.nodes());
}

bool MultigridSolver::factor(double shift, double step) {
  if (!real_) real_ = std::make_unique<Multigrid<double>>(lattice_, discretise_);
  step_ = step;
  return real_->factor(shift, step);
}

bool MultigridSolver::factor(Complex shift, Complex step) {
  if (!complex_) {
    complex_ = std::make_unique<Multigrid<Complex>>(lattice_, discretise_);
    cb_.resize(lattice_.nodes()), cx_.resize(lattice_.nodes());
  }
  complex_step_ = step;
  return complex_->factor(shift, step);
}

void MultigridSolver::solve(double* b, const ThreadArena& arena) {
  // Contributions of nodes with given values to their neighbours.
  for (const uint32_t node : fixed_) given_[node] = b[node];
  if (!fixed_.empty()) {
    fine_.apply(given_.data(), moved_.data(), 0, step_, arena);
    for (size_t i = 0; i < moved_.size(); ++i) b[i] += moved_[i];
  }
  real_->solve(b, x_.data(), kReduction, arena);
  std::ranges::copy(x_, b);
  for (const uint32_t node : fixed_) b[node] = given_[node];
}

void MultigridSolver::solve(double* re, double* im, const ThreadArena& arena) {
  for (size_t i = 0; i < cb_.size(); ++i) cb_[i] = {re[i], im[i]};
  for (const auto& [values, unit] : {std::pair{re, Complex(1)}, std::pair{im, Complex(0, 1)}}) {
    if (fixed_.empty()) break;
    for (const uint32_t node : fixed_) given_[node] = values[node];
    fine_.apply(given_.data(), moved_.data(), 0, 1, arena);
    for (size_t i = 0; i < moved_.size(); ++i) cb_[i] += moved_[i] * (complex_step_ * unit);
  }
  complex_->solve(cb_.data(), cx_.data(), kReduction, arena);
  for (size_t i = 0, k = 0; i < cx_.size(); ++i) {
    if (k < fixed_.size() && fixed_[k] == i) {
      ++k;  // keeps its values
    } else {
      re[i] = cx_[i].re, im[i] = cx_[i].im;
    }
  }
}

}  // namespace truestep::lattice
