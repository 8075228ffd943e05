#include "engine/integrators/cvode/cvode_jacobian.h"

#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/integrators/linear/sparse_factors.h"

namespace truestep {

CvodeJacobian::CvodeJacobian(const RightHandSide& f) : n_(f.size()) {
  bind(f);
  analytic_ = second_ ? second_->has_jacobian() : f.has_jacobian();
  const size_t m = second_ ? n_ / 2 : n_;
  if (shape_.kind == MatrixShape::Kind::banded && 2 * (shape_.lower + shape_.upper) < m) {
    kind_ = Kind::band, interleaved_ = second_ != nullptr;
    lower_ = interleaved_ ? 2 * shape_.lower + 1 : shape_.lower;
    upper_ = interleaved_ ? 2 * shape_.upper + 1 : shape_.upper;
  } else if (shape_.kind == MatrixShape::Kind::sparse && m > 100 && analytic_) {
    kind_ = Kind::sparse;
  }
  if (second_ && !analytic_) {
    // Differences give df/dy as a whole, whose two halves do not form a band.
    kind_ = Kind::dense, interleaved_ = false;
  }
  if (kind_ == Kind::dense && n_ > 5000) {
    throw Error("too_many_unknowns",
                "CVODE needs the derivatives of the right-hand side for more than 5000 "
                "equations without a band");
  }
  if (analytic_) {
    first_.resize(shape_.values(m));
    if (second_) second_values_.resize(first_.size());
  }
  if (interleaved_) y_.resize(n_);
}

void CvodeJacobian::bind(const RightHandSide& f) {
  f_ = &f, second_ = f.second_order();
  shape_ = second_ ? second_->shape() : f.jacobian_shape();
}

void CvodeJacobian::to_cvode(const double* ours, double* theirs) const {
  if (!interleaved_) {
    std::copy_n(ours, n_, theirs);
    return;
  }
  for (size_t i = 0; i < n_ / 2; ++i) theirs[2 * i] = ours[i], theirs[2 * i + 1] = ours[n_ / 2 + i];
}
void CvodeJacobian::from_cvode(const double* theirs, double* ours) const {
  if (!interleaved_) {
    std::copy_n(theirs, n_, ours);
    return;
  }
  for (size_t i = 0; i < n_ / 2; ++i) ours[i] = theirs[2 * i], ours[n_ / 2 + i] = theirs[2 * i + 1];
}

template <class F>
void CvodeJacobian::for_entries(const MatrixShape& shape, size_t n, F&& f) const {
  for (size_t j = 0; j < n; ++j) {
    if (shape.kind == MatrixShape::Kind::dense) {
      for (size_t i = 0; i < n; ++i) f(i, j, j * n + i);
    } else if (shape.kind == MatrixShape::Kind::banded) {
      const size_t end = std::min(n, j + shape.lower + 1), width = shape.lower + shape.upper + 1;
      for (size_t i = j > shape.upper ? j - shape.upper : 0; i < end; ++i) {
        f(i, j, j * width + shape.upper + i - j);
      }
    } else {
      for (int32_t k = shape.column_start[j]; k < shape.column_start[j + 1]; ++k) {
        f(size_t(shape.rows[size_t(k)]), j, size_t(k));
      }
    }
  }
}

void CvodeJacobian::put(SUNMatrix j, size_t row, size_t column, double value) const {
  const auto r = sunindextype(row), c = sunindextype(column);
  if (kind_ == Kind::band) {
    SM_ELEMENT_B(j, r, c) = value;
  } else {
    SM_ELEMENT_D(j, r, c) = value;
  }
}

void CvodeJacobian::evaluate(double t, const double* y, SUNMatrix j) {
  const size_t m = second_ ? n_ / 2 : n_;
  if (interleaved_) {
    from_cvode(y, y_.data());
    y = y_.data();
  }
  if (second_) {
    second_->jacobian(t, y, y + m, first_.data(), second_values_.data());
  } else {
    f_->jacobian(t, y, first_.data());
  }
  SUNMatZero(j);
  if (kind_ == Kind::sparse) {
    SM_ELEMENT_D(j, 0, 1) = 1;
    return;
  }
  const auto place = [&](size_t i, size_t half) { return interleaved_ ? 2 * i + half : i + half * m; };
  if (!second_) {
    for_entries(shape_, n_, [&](size_t i, size_t c, size_t k) { put(j, i, c, first_[k]); });
    return;
  }
  for (size_t i = 0; i < m; ++i) put(j, place(i, 0), place(i, 1), 1);
  for_entries(shape_, m, [&](size_t i, size_t c, size_t k) {
    put(j, place(i, 1), place(c, 0), first_[k]);
    put(j, place(i, 1), place(c, 1), second_values_[k]);
  });
}

// J = [0 1; 0 0] stands for the Jacobian, which stays in first_ and second_values_: CVODE forms I - gamma J
// of it, from which the solver reads gamma.
SUNMatrix CvodeJacobian::sparse_matrix(SUNContext context) const {
  return SUNDenseMatrix(2, 2, context);
}

// A linear solver for CVODE on top of our sparse factors, (I - gamma J) x = b; equations of second order in
// half the size as in newton_matrix.h.
struct CvodeJacobian::Sparse {
  const CvodeJacobian* jacobian;
  SparseFactors factors;
  double gamma = 0;

  static Sparse& of(SUNLinearSolver s) { return *static_cast<Sparse*>(s->content); }

  static int setup(SUNLinearSolver s, SUNMatrix a) {
    try {
      Sparse& own = of(s);
      const CvodeJacobian& j = *own.jacobian;
      const double z = own.gamma = -SM_ELEMENT_D(a, 0, 1);
      const bool factored = j.second_ ? own.factors.factor(j.first_.data(), j.second_values_.data(), z * z, z,
                                                           j.second_->symmetric_in())
                                      : own.factors.factor(j.first_.data(), nullptr, z, 0.0);
      return factored ? 0 : 1;
    } catch (...) {
      return -1;
    }
  }

  static int solve(SUNLinearSolver s, SUNMatrix, N_Vector x, N_Vector b, realtype) {
    try {
      Sparse& own = of(s);
      const CvodeJacobian& j = *own.jacobian;
      double* p = N_VGetArrayPointer(x);
      std::copy_n(N_VGetArrayPointer(b), j.n_, p);
      if (j.second_) {
        const size_t m = j.n_ / 2;
        double* q = p + m;
        j.for_entries(j.shape_, m, [&](size_t row, size_t column, size_t k) {
          q[row] += own.gamma * (j.first_[k] * p[column]);
        });
        own.factors.solve(q);
        for (size_t i = 0; i < m; ++i) p[i] += own.gamma * q[i];
      } else {
        own.factors.solve(p);
      }
      return 0;
    } catch (...) {
      return -1;
    }
  }
};

SUNLinearSolver CvodeJacobian::sparse_solver(SUNContext context) const {
  SUNLinearSolver s = SUNLinSolNewEmpty(context);
  if (!s) return nullptr;
  s->content = new Sparse{this, {second_ ? n_ / 2 : n_, shape_.column_start, shape_.rows}};
  s->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; };
  s->ops->initialize = [](SUNLinearSolver) { return 0; };
  s->ops->setup = Sparse::setup;
  s->ops->solve = Sparse::solve;
  s->ops->free = [](SUNLinearSolver solver) {
    delete &Sparse::of(solver);
    solver->content = nullptr;
    SUNLinSolFreeEmpty(solver);
    return 0;
  };
  return s;
}

}  // namespace truestep
