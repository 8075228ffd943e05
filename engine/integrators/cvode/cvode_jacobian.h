// The Jacobian of a right-hand side as CVODE's Newton iteration sees it: the type of matrix, where the values
// go, and the order of the unknowns (second-order equations with a band are interleaved).
#pragma once
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

#include <vector>

#include "engine/core/equations/right_hand_side.h"

namespace truestep {

class CvodeJacobian {
 public:
  enum class Kind : uint8_t { dense, band, sparse };

  explicit CvodeJacobian(const RightHandSide& f);
  /// Switches to another object for the same equations, with the same shape.
  void bind(const RightHandSide& f);

  Kind kind() const { return kind_; }
  size_t lower() const { return lower_; }
  size_t upper() const { return upper_; }
  /// False: CVODE's own differences (dense and band).
  bool analytic() const { return analytic_; }
  bool interleaved() const { return interleaved_; }

  /// Between our order of the unknowns and CVODE's.
  void to_cvode(const double* ours, double* theirs) const;
  void from_cvode(const double* theirs, double* ours) const;

  /// df/dy at (t, y), y in CVODE's order.
  void evaluate(double t, const double* y, SUNMatrix j);

  /// For Kind::sparse; the solver refers to this.
  SUNMatrix sparse_matrix(SUNContext context) const;
  SUNLinearSolver sparse_solver(SUNContext context) const;

 private:
  struct Sparse;
  void put(SUNMatrix j, size_t row, size_t column, double value) const;
  template <class F>
  void for_entries(const MatrixShape& shape, size_t n, F&& f) const;

  const RightHandSide* f_;
  const SecondOrder* second_;
  size_t n_;
  MatrixShape shape_;
  Kind kind_ = Kind::dense;
  size_t lower_ = 0, upper_ = 0;
  bool analytic_ = false, interleaved_ = false;
  std::vector<double> first_, second_values_, y_;
};

}  // namespace truestep
