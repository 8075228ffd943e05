// What implicit methods see of an integration: the right-hand side with its linear systems, a fixed number of
// work arrays, and the weighted norm of errors. Methods are written for any number of equations and meet one
// of two classes behind this face: SmallEquations<N> up to kSmallest equations, LargeEquations beyond. Next
// to Jacobians and solutions the calls through it are nothing; a method of which benchmarks say otherwise is
// compiled for some SmallEquations<N> as well (small_equations.h).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "engine/integrators/advance.h"
#include "engine/math/complex.h"

namespace truestep {

inline constexpr size_t kWorkArrays = 26;
inline constexpr size_t kSmallest = 8;  ///< up to this many equations, SmallEquations

/// Magnitude below which changes of a component do not matter: where the absolute tolerance takes over.
inline double typical_size(const Tolerance& t) {
  return t.relative > 0 && t.absolute > 0 ? std::clamp(t.absolute / t.relative, 1e-10, 1.0) : 1.0;
}

/// sqrt(1/n sum_i (e_i / (absolute + relative * max(|y_i|, |z_i|)))^2), NaN as soon as any e_i is. Eight
/// sums, one per lane: vectorises, and the order is the same everywhere.
inline double weighted_norm(const Tolerance& tolerance, size_t n, const double* e, const double* y,
                            const double* z) {
  const double relative = tolerance.relative;
  const auto ratio = [&](size_t i, double absolute) {
    const double p = std::abs(y[i]), q = std::abs(z[i]);
    const double r = e[i] / (absolute + relative * (p > q ? p : q));
    return r * r;
  };
  std::array<double, 8> lane{};
  const auto sum = [&](auto absolute) {
    size_t i = 0;
    for (; i + 8 <= n; i += 8) {
      for (size_t k = 0; k < 8; ++k) lane[k] += ratio(i + k, absolute(i + k));
    }
    for (size_t k = 0; i + k < n; ++k) lane[k] += ratio(i + k, absolute(i + k));
  };
  if (tolerance.absolute_each.empty()) {
    const double absolute = tolerance.absolute;
    sum([=](size_t) { return absolute; });
  } else {
    const double* each = tolerance.absolute_each.data();
    sum([=](size_t i) { return each[i]; });
  }
  const double total =
      ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
  return std::sqrt(total / double(n));
}

class Equations {
 public:
  /// Adds the counts to the run's statistics, also when a method throws.
  virtual ~Equations();
  Equations(const Equations&) = delete;
  Equations& operator=(const Equations&) = delete;

  const RightHandSide& f() const { return a_.f; }
  Advance& advance() const { return a_; }
  Statistics& count() { return count_; }
  size_t size() const { return n_; }
  /// Elements of every array that loops may run over; those beyond size() are 0 or harmless.
  size_t padded() const { return padded_; }
  double* array(size_t k) { return arrays_ + k * stride_; }

  void rate(double t, const double* y, double* dydt) {
    ++count_.rates;
    a_.f.rate(t, y, dydt);
  }
  double norm(const double* e, const double* y, const double* z) const;

  /// J at (t, y); fy = f(t, y).
  virtual void differentiate(double t, const double* y, const double* fy) = 0;
  /// Factors of I - z J; false: singular.
  virtual bool factor(double z) = 0;
  virtual bool factor(Complex z) = 0;
  /// b = (I - z J)^-1 b with the last real or complex factors.
  virtual void solve(double* b) = 0;
  virtual void solve(double* re, double* im) = 0;

 protected:
  Equations(Advance& a, size_t padded, double* arrays, size_t stride)
      : a_(a), n_(a.f.size()), padded_(padded), stride_(stride), arrays_(arrays) {}

  Advance& a_;
  Statistics count_;

 private:
  size_t n_, padded_, stride_;
  double* arrays_;
};

/// body(equations) with the class that fits; not at all if there are none.
void with_equations(Advance& a, const std::function<void(Equations&)>& body);

/// out = y + sum_{j < count} c[j] k_j in one pass, k_j = k + j * stride; y may be null (0).
void combine(size_t n, double* out, const double* y, const double* c, const double* k, size_t stride,
             size_t count);
/// The same over all components of the equations' arrays, k_j = array first + j.
inline void combine(Equations& eq, double* out, const double* y, const double* c, size_t first,
                    size_t count) {
  const double* k = eq.array(first);
  combine(eq.padded(), out, y, c, k, size_t(eq.array(1) - eq.array(0)), count);
}

}  // namespace truestep
