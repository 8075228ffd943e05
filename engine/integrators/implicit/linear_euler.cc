// Linearly implicit Euler method: implicit Euler's step with one Newton step from the solution at its start,
//   (I - h J) d = h f(t + h, y),  y1 = y + d,  J = df/dy(t + h, y)
// (Hairer, Wanner 1996, section IV.9). Order 1, L-stable, and implicit Euler itself where f is
// linear in y.
#include <cmath>

#include "engine/base/errors.h"
#include "engine/integrators/equations.h"
#include "engine/integrators/explicit/drive_fixed.h"
#include "engine/integrators/implicit/implicit_methods.h"

namespace truestep {

namespace {

class LinearEuler final : public Interpolant {
 public:
  explicit LinearEuler(Equations& eq) : eq_(eq) { std::copy_n(eq.advance().y, eq.size(), eq.array(y_)); }

  // --- drive_fixed.h

  void begin(double) {}
  bool step(double t, double h) {
    const size_t n = eq_.padded();
    const double* y = eq_.array(y_);
    double *d = eq_.array(kIncrement), *y_new = eq_.array(1 - y_);
    eq_.rate(t + h, y, d);
    eq_.differentiate(t + h, y, d);
    if (!eq_.factor(h)) throw Instability("", "y", -1, "the matrix of the step is singular");
    for (size_t i = 0; i < n; ++i) d[i] *= h;
    eq_.solve(d);
    for (size_t i = 0; i < n; ++i) y_new[i] = y[i] + d[i];
    t_ = t, h_ = h;
    return true;
  }
  double* candidate() { return eq_.array(1 - y_); }
  const double* solution() const { return eq_.array(y_); }
  const Interpolant& between(double, double) {
    eq_.rate(t_, eq_.array(y_), eq_.array(kRate));
    eq_.rate(t_ + h_, eq_.array(1 - y_), eq_.array(kEndRate));
    return *this;
  }
  void accept(double) { y_ = 1 - y_; }
  long long worst(double) const { return 0; }

  // --- Interpolant: Hermite, order 3

  void at(double s, double* out) const override {
    const double *y0 = eq_.array(y_), *y1 = eq_.array(1 - y_), *k0 = eq_.array(kRate),
                 *k1 = eq_.array(kEndRate);
    const double r = 1 - s, w = s * s * (3 - 2 * s), w0 = h_ * s * r * r, w1 = -h_ * s * s * r;
    for (size_t i = 0; i < eq_.size(); ++i) {
      out[i] = y0[i] + (w * (y1[i] - y0[i]) + (w0 * k0[i] + w1 * k1[i]));
    }
  }

 private:
  // Arrays 0 and 1: the solution at both ends of a step, alternating.
  enum : size_t { kIncrement = 2, kRate, kEndRate };

  Equations& eq_;
  size_t y_ = 0;
  double t_ = 0, h_ = 0;
};

}  // namespace

void advance_linear_implicit_euler(Advance& a) {
  with_equations(a, [&a](Equations& eq) {
    LinearEuler method(eq);
    drive_fixed(a, method);
  });
}

}  // namespace truestep
