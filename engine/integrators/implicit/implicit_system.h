// The linear systems of implicit methods on fields with a Jacobian: with the velocity u as the unknown and
// the position x = x0 + s u, the equation M (u - u0) = g f(x, u, t) has the matrix
//   A = M - g df/du - g s df/dx.
// Implicit Euler has g = s = h; other methods differ in g and s only. Rows that are held keep their velocity:
// their rows and columns of A become those of the identity.
#pragma once
#include <span>
#include <vector>

#include "engine/integrators/implicit/newton/row_contacts.h"
#include "engine/integrators/motion.h"
#include "engine/math/block_sparse.h"
#include "engine/math/solvers/block_solver.h"

namespace truestep {

/// Which derivatives A is made of: ForceField::jacobian, ForceField::definite_jacobian, or a blend of both.
enum class Derivatives : uint8_t { exact, definite, both };

class ImplicitSystem {
 public:
  explicit ImplicitSystem(Motion& m);

  /// Allocates what blends of Jacobians and solving the systems need, so that no later step does.
  void reserve();
  /// Evaluates df/dx and df/du at (t, x, u); `both` adds the definite ones to existing exact ones. df/du is
  /// taken at `x_rate` if given.
  void differentiate(double t, std::span<const double> x, std::span<const double> u, Derivatives which,
                     std::span<const double> x_rate = {});
  /// df/dx, exact or definite, of the last call.
  const BlockSparse& force_slope() const;
  /// A from the last derivatives; for `both`, a fraction `definite` in [0, 1] of it is the definite one.
  void assemble(double g, double s, double definite = 0);
  /// Rows on surfaces; empty if there are none.
  const std::optional<RowContacts>& contacts() const { return contacts_; }
  /// y = A x.
  void multiply(std::span<const double> x, std::span<double> y) const;
  /// Removes the directions prescribed by surfaces from A: their rows and columns become those of the masses.
  void constrain();
  /// Solves A d = b to the requested relative accuracy. Instability when A is singular.
  BlockSolver::Result::Sign solve(std::span<const double> b, std::span<double> d, double accuracy);

  /// The same for another b with the same A, reusing the last solve's work.
  void solve_again(std::span<const double> b, std::span<double> d, double accuracy);

  /// sqrt(sum_i w_i r_i^2) of the unavoidable rounding error r of M (u - u0) - g f at (x, u): a position is
  /// known to eps |x|, so a force is known to eps |df/dx| |x|, row by row. Call after assemble.
  double rounding_floor(std::span<const double> x, std::span<const double> u, double g);
  /// J, sum_ij |x_i| |df/dx_ij| |x_j| =: E. A potential made of squares of changes of length knows them to
  /// eps |x|, hence itself to eps sqrt(2 V E) + eps^2 E (Cauchy's inequality). Call after differentiate.
  double rounding_energy(std::span<const double> x);

  std::span<const double> inverse_mass() const { return w_; }
  size_t width() const { return width_; }  ///< components per row

  /// sum_i term(i) over all rows, in fixed blocks.
  template <class Term>
  double sum(Term term) {
    m_.input.arena.for_blocks(w_.size(), kBlockRows, [&](size_t begin, size_t end) {
      double s = 0;
      for (size_t i = begin; i < end; ++i) s += term(i);
      partial_[begin / kBlockRows] = s;
    });
    double total = 0;
    for (const double p : partial_) total += p;
    return total;
  }
  /// sum_k term(k) over the components of all rows that are not held.
  template <class Term>
  double sum_free(Term term) {
    return sum([&](size_t i) {
      double s = 0;
      if (w_[i] > 0) {
        for (size_t k = i * width_; k < (i + 1) * width_; ++k) s += term(k, w_[i]);
      }
      return s;
    });
  }

 private:
  struct Matrices;
  Motion& m_;
  std::span<const double> w_;
  size_t width_;
  std::optional<RowContacts> contacts_;
  Matrices& matrices_;
  std::span<double> partial_;  // one number per block of rows
  double condition_ = 1;
  std::span<const double> places_;  // m, at the last derivatives
};

}  // namespace truestep
