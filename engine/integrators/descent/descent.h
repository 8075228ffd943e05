// A step of implicit Euler as descent on its incremental potential over the positions x at the step's end,
//   g(x) = 1/2 |x - x0 - h v0|^2_M / h^2 + V(x) + h R(x0, (x - x0) / h),   v = (x - x0) / h,
// whose gradient is r = M (u - v0) / h - f(x, u), u = (x - x0) / h. Dissipative forces are evaluated at the
// positions at the step's start if the field supports that (core/equations/lagged_dissipation.h). Held rows
// keep their velocity.
#pragma once
#include "engine/integrators/motion.h"

namespace truestep {

class Descent {
 public:
  explicit Descent(Motion& m);

  /// r (N) at x, 0 on held rows. x may be any finite positions.
  void gradient(std::span<const double> x, std::span<double> r);
  /// (x - x0) / h of all rows into the array that the next gradient overwrites.
  std::span<const double> velocity(std::span<const double> x);
  /// Writes x and (x - x0) / h to the state; held rows keep their velocity.
  void finish(std::span<const double> x);

  std::span<const double> x0() const { return x0_; }
  std::span<const double> v0() const { return v0_; }
  std::span<const double> inverse_mass() const { return w_; }
  double h() const { return m_.input.h; }
  double t_end() const { return m_.input.t + m_.input.h; }
  size_t size() const { return x0_.size(); }

  /// sum a_k b_k, in a fixed order.
  static double dot(std::span<const double> a, std::span<const double> b);

 private:
  Motion& m_;
  std::span<const double> w_;
  std::span<double> x0_, v0_, u_;
};

}  // namespace truestep
