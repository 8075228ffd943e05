// Small systems: y = (x, v), F(y) = (G(x) v, a(x, v, t + h)), Newton's method on y' = y + h F(y') with the
// matrix I - h dF/dy by central differences and dense LU. The residual is exact, so the differences (relative
// error about 1e-10) cost at most an iteration, not accuracy.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/errors.h"
#include "engine/integrators/implicit/implicit.h"
#include "engine/math/solvers/dense_lu.h"

namespace truestep {

namespace {

// At most kDenseUnknowns rows, without allocation.
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kDenseUnknowns, kDenseUnknowns>;
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kDenseUnknowns, 1>;

class StepEquations {
 public:
  StepEquations(Motion& m)
      : m_(m), nx_(static_cast<Eigen::Index>(m.x.size())), n_(nx_ + static_cast<Eigen::Index>(m.v.size())) {}

  Eigen::Index size() const { return n_; }
  Vector start() const {
    Vector y(n_);
    std::copy(m_.x.begin(), m_.x.end(), y.data());
    std::copy(m_.v.begin(), m_.v.end(), y.data() + nx_);
    return y;
  }
  void finish(const Vector& y) {
    std::copy(y.data(), y.data() + nx_, m_.x.begin());
    std::copy(y.data() + nx_, y.data() + n_, m_.v.begin());
  }
  Vector rates(const Vector& y) {
    Vector f(n_);
    const std::span<const double> x{y.data(), m_.x.size()}, v{y.data() + nx_, m_.v.size()};
    const double t = m_.input.t + m_.input.h;
    const auto rate = m_.rate(t, x, v, {f.data(), m_.x.size()});
    if (rate.data() != f.data()) std::copy(rate.begin(), rate.end(), f.data());
    m_.acceleration(t, x, v, {f.data() + nx_, m_.v.size()});
    return f;
  }
  // I - h dF/dy
  Matrix matrix(const Vector& y) {
    Matrix a = Matrix::Identity(n_, n_);
    for (Eigen::Index j = 0; j < n_; ++j) {
      const double e = 6e-6 * std::max(1.0, std::abs(y[j]));  // cube root of the rounding unit
      Vector up = y, down = y;
      up[j] += e, down[j] -= e;
      a.col(j) -= m_.input.h / (up[j] - down[j]) * (rates(up) - rates(down));
    }
    return a;
  }

  // matrix(y)^-1 b; not a number where that is singular.
  Vector solve(const Vector& y, Vector b) {
    auto& lu = m_.input.workspace.object<DenseLu<double>>("integrator.dense_lu");
    lu.resize(static_cast<size_t>(n_));
    const Matrix a = matrix(y);
    std::copy_n(a.data(), n_ * n_, lu.matrix());
    if (!lu.factor()) return Vector::Constant(n_, std::numeric_limits<double>::quiet_NaN());
    lu.solve(b.data());
    return b;
  }

 private:
  Motion& m_;
  Eigen::Index nx_, n_;
};

}  // namespace

void implicit_euler_dense(Motion& m, const IntegratorOptions& options, NewtonSteps steps) {
  const double h = m.input.h;
  StepEquations eq(m);
  const Vector y0 = eq.start();
  if (steps == NewtonSteps::one) {
    eq.finish(y0 + eq.solve(y0, h * eq.rates(y0)));
    return;
  }
  Vector y = y0, residual = -h * eq.rates(y0);
  const double scale = std::max(residual.norm(), y0.norm());
  // Values that have decayed until their squares underflow count as zero: a norm can no longer tell better
  // from worse there.
  constexpr double kNothing = 1e-150;
  for (int it = 0; residual.norm() > options.newton_tolerance * scale + kNothing; ++it) {
    const Vector direction = eq.solve(y, -residual);
    double share = 1;
    Vector next = y + direction, next_residual = next - y0 - h * eq.rates(next);
    while (!(next_residual.norm() < residual.norm()) && share > 1e-3) {
      share *= 0.5;
      next = y + share * direction;
      next_residual = next - y0 - h * eq.rates(next);
    }
    const bool at_rounding = direction.norm() <= 1e-13 * y.norm();
    if (next_residual.norm() < residual.norm()) {
      y = next, residual = next_residual;
    } else if (!at_rounding) {
      throw Instability("", "velocity", -1,
                        "Newton's method found no decrease of the residual; a smaller dt would help");
    }
    if (at_rounding) break;
    if (it >= options.max_newton_iterations) {
      throw Instability("", "velocity", -1,
                        "Newton's method did not converge in " +
                            std::to_string(options.max_newton_iterations) + " iterations");
    }
  }
  eq.finish(y);
}

}  // namespace truestep
