// The linear systems of implicit methods: (I - z J) x = b with J = df/dy of a right-hand side, real or
// complex z. Second-order equations, y = (x, v) with A = da/dx and B = da/dv, are solved in half the size:
//   (I - z B - z^2 A) q = s + z A r,  p = r + z q      for b = (r, s), x = (p, q).
// Jacobians are the right-hand side's own or differences, with as many columns at once as the pattern allows.
// The shape determines the factorisation: dense, band (if an ordering with few diagonals exists) or sparse.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "engine/core/equations/right_hand_side.h"
#include "engine/integrators/advance.h"
#include "engine/math/complex.h"
#include "engine/math/solvers/band_lu.h"
#include "engine/math/solvers/dense_lu.h"
#include "engine/math/solvers/symbolic_fill.h"

namespace truestep {

/// Sparse factorisation behind an interface, so that Eigen's headers stay in one file.
class SparseFactors;

class NewtonMatrix {
 public:
  /// own: the right-hand side solves by itself.
  enum class Kind : uint8_t { dense, band, sparse, own };

  NewtonMatrix();
  ~NewtonMatrix();
  NewtonMatrix(const NewtonMatrix&) = delete;
  NewtonMatrix& operator=(const NewtonMatrix&) = delete;

  /// Must come first; cheap when the shape is unchanged.
  void bind(const RightHandSide& f);
  Kind kind() const { return kind_; }
  /// Unknowns of the factorised system: the number of equations or half of it.
  size_t unknowns() const { return m_; }
  bool half_size() const { return second_order_ != nullptr; }
  /// Whether a sparse real system is symmetric in blocks (symmetric_factors.h).
  bool symmetric() const { return second_order_ && !second_order_->symmetric_in().empty(); }

  /// Multiplications of one real factorisation and of one solve, after bind.
  FactorWork factor_work() const;
  /// Operations of one differentiation when one evaluation of f takes `rate`.
  double jacobian_work(double rate) const;

  /// J at (t, y); `fy` is f(t, y), used only by differences, as is `typical`, the magnitude below which
  /// changes of a component do not matter.
  void differentiate(double t, const double* y, const double* fy, double typical, Statistics& count);
  /// False: singular or not finite.
  bool factor(double z);
  bool factor(Complex z);
  /// x = (I - z J)^-1 b in place, after a factorisation with a real or a complex z.
  void solve(double* b);
  void solve(double* re, double* im);

  /// For methods that solve for an acceleration: I - with_v B - with_x A, of half size.
  bool factor_second_order(double with_x, double with_v);
  void solve_second_order(double* b);

 private:
  template <class T>
  struct Factors {
    DenseLu<T> dense;
    BandLu<T> band;
    std::vector<T> permuted;  // right-hand side in band order
    bool sized = false;
  };

  void analyse(const MatrixShape& shape);
  template <class Evaluate>
  void differences(const double* at, const double* f_at, double typical, double* values, Evaluate&& evaluate);
  template <class T>
  bool assemble_and_factor(Factors<T>& f, T with_first, T with_second);
  template <class T>
  void solve_reduced(Factors<T>& f, T* b);
  void multiply_first(const double* x, double* y) const;
  template <class F>
  void for_column(size_t j, F&& f) const;

  const RightHandSide* f_ = nullptr;
  const SecondOrder* second_order_ = nullptr;
  LinearSolver* own_ = nullptr;
  size_t m_ = 0;
  MatrixShape shape_;  // of J, or of A and B; its spans point into the two vectors below
  std::vector<int32_t> column_start_, rows_;
  Kind kind_ = Kind::dense;
  size_t lower_ = 0, upper_ = 0;        // band, after reordering
  std::vector<int32_t> order_, place_;  // band; empty: in the original order
  std::vector<int32_t> group_;          // of columns differenced together
  int32_t groups_ = 0;

  std::vector<double> first_, second_;  // values of J, or of A and B
  std::vector<double> moved_, rate_, product_;
  std::vector<Complex> complex_rhs_;
  double z_ = 0;
  Complex z_complex_;
  Factors<double> real_;
  Factors<Complex> complex_;
  std::unique_ptr<SparseFactors> sparse_;
};

}  // namespace truestep
