// What implicit methods see of an integration: the right-hand side with its linear systems, a fixed number of
// work arrays, and the weighted norm of errors. Two classes with the same members: SmallEquations<N> for N <=
// 8 has a compile-time size (arrays on the stack, unrolled loops, dense factors in one or two cache lines),
// LargeEquations handles the rest. Methods are templates over the two; visit_equations chooses.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/integrators/advance.h"
#include "engine/integrators/implicit/newton/newton_matrix.h"
#include "engine/math/solvers/small_lu.h"

namespace truestep {

inline constexpr size_t kWorkArrays = 26;
inline constexpr size_t kSmallest = 8;  ///< up to this many equations, SmallEquations

/// Magnitude below which changes of a component do not matter: where the absolute tolerance takes over.
inline double typical_size(const Tolerance& t) {
  return t.relative > 0 && t.absolute > 0 ? std::clamp(t.absolute / t.relative, 1e-10, 1.0) : 1.0;
}

/// Shared by both: evaluations and their counts.
template <class Derived>
class EquationsBase {
 public:
  explicit EquationsBase(Advance& a) : a_(a) {}

  const RightHandSide& f() const { return a_.f; }
  Advance& advance() const { return a_; }
  Statistics& count() { return count_; }
  void rate(double t, const double* y, double* dydt) {
    ++count_.rates;
    a_.f.rate(t, y, dydt);
  }

  /// sqrt(1/n sum_i (e_i / (absolute + relative * max(|y_i|, |z_i|)))^2), NaN as soon as any e_i is.
  double norm(const double* e, const double* y, const double* z) const {
    const auto& self = static_cast<const Derived&>(*this);
    const size_t n = self.size();
    const double relative = a_.tolerance.relative;
    const auto ratio = [&](size_t i, double absolute) {
      const double p = std::abs(y[i]), q = std::abs(z[i]);
      const double r = e[i] / (absolute + relative * (p > q ? p : q));
      return r * r;
    };
    // Eight sums, one per lane: vectorises, and the order is the same everywhere.
    std::array<double, 8> lane{};
    const auto sum = [&](auto absolute) {
      size_t i = 0;
      for (; i + 8 <= n; i += 8) {
        for (size_t k = 0; k < 8; ++k) lane[k] += ratio(i + k, absolute(i + k));
      }
      for (size_t k = 0; i + k < n; ++k) lane[k] += ratio(i + k, absolute(i + k));
    };
    if (a_.tolerance.absolute_each.empty()) {
      const double absolute = a_.tolerance.absolute;
      sum([=](size_t) { return absolute; });
    } else {
      const double* each = a_.tolerance.absolute_each.data();
      sum([=](size_t i) { return each[i]; });
    }
    const double total =
        ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
    return std::sqrt(total / double(n));
  }

 protected:
  Advance& a_;
  Statistics count_;
};

template <int N>
class SmallEquations : public EquationsBase<SmallEquations<N>> {
  using Base = EquationsBase<SmallEquations<N>>;

 public:
  explicit SmallEquations(Advance& a) : Base(a) {
    for (auto& array : arrays_) array.fill(0);
  }
  static constexpr size_t size() { return N; }
  /// Elements of every array, in whole vector registers; those beyond size() are 0 or harmless.
  static constexpr size_t padded() { return N <= 2 ? N : (N + 3) / 4 * 4; }
  double* array(size_t k) { return arrays_[k].data(); }

  void differentiate(double t, const double* y, const double* fy);
  bool factor(double z) { return fill_and_factor(real_, z); }
  bool factor(Complex z) { return fill_and_factor(complex_, z); }
  void solve(double* b) {
    ++this->count_.solves;
    real_.solve(b);
  }
  void solve(double* re, double* im) {
    ++this->count_.solves;
    Complex b[N];
    for (int i = 0; i < N; ++i) b[i] = {re[i], im[i]};
    complex_.solve(b);
    for (int i = 0; i < N; ++i) re[i] = b[i].re, im[i] = b[i].im;
  }

 private:
  template <class T>
  bool fill_and_factor(SmallLu<T, N>& lu, T z) {
    ++this->count_.factorisations;
    T* m = lu.matrix();
#pragma GCC unroll 64
    for (int k = 0; k < N * N; ++k) m[k] = T(0) - jacobian_[size_t(k)] * z;
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) m[k * N + k] += T(1);
    return lu.factor();
  }
  void expand(const MatrixShape& shape, const double* values, size_t m, size_t row, size_t column);

  alignas(64) std::array<std::array<double, (N <= 2 ? N : (N + 3) / 4 * 4)>, kWorkArrays> arrays_;
  std::array<double, size_t(N* N)> jacobian_;
  SmallLu<double, N> real_;
  SmallLu<Complex, N> complex_;
};

class LargeEquations : public EquationsBase<LargeEquations> {
 public:
  explicit LargeEquations(Advance& a)
      : EquationsBase(a),
        n_(a.f.size()),
        // One extra cache line, so that arrays of 4096 bytes do not map to the same cache sets.
        stride_((n_ + 7) / 8 * 8 + 8),
        arrays_(a.workspace.doubles("integrator.implicit_arrays", kWorkArrays * stride_).data()),
        matrix_(a.workspace.object<NewtonMatrix>("integrator.newton_matrix")) {
    matrix_.bind(a.f);
  }
  size_t size() const { return n_; }
  size_t padded() const { return n_; }
  double* array(size_t k) { return arrays_ + k * stride_; }
  NewtonMatrix& matrix() { return matrix_; }

  void differentiate(double t, const double* y, const double* fy) {
    matrix_.differentiate(t, y, fy, typical_size(a_.tolerance), count_);
  }
  bool factor(double z) {
    ++count_.factorisations;
    return matrix_.factor(z);
  }
  bool factor(Complex z) {
    ++count_.factorisations;
    return matrix_.factor(z);
  }
  void solve(double* b) {
    ++count_.solves;
    matrix_.solve(b);
  }
  void solve(double* re, double* im) {
    ++count_.solves;
    matrix_.solve(re, im);
  }

 private:
  size_t n_, stride_;
  double* arrays_;
  NewtonMatrix& matrix_;
};

namespace detail {
// Adds the counts to a.statistics, also when body throws.
template <class Equations, class Body>
void run_and_count(Advance& a, Equations&& equations, Body&& body) {
  struct Report {
    Advance& a;
    const Statistics& s;
    ~Report() {
      if (!a.statistics) return;
      a.statistics->rates += s.rates, a.statistics->jacobians += s.jacobians;
      a.statistics->factorisations += s.factorisations, a.statistics->solves += s.solves;
    }
  } report{a, equations.count()};
  body(equations);
}
}  // namespace detail

/// body(equations) with LargeEquations, whatever the size.
template <class Body>
void with_large_equations(Advance& a, Body&& body) {
  if (a.f.size() == 0) {
    a.reached = a.t_end;
    return;
  }
  detail::run_and_count(a, LargeEquations(a), body);
}

/// body(equations) with the class that fits.
template <class Body>
void visit_equations(Advance& a, Body&& body) {
  const auto run = [&](auto&& equations) { detail::run_and_count(a, equations, body); };
  switch (a.f.size()) {
    case 0:
      a.reached = a.t_end;
      return;
    case 1:
      return run(SmallEquations<1>(a));
    case 2:
      return run(SmallEquations<2>(a));
    case 3:
      return run(SmallEquations<3>(a));
    case 4:
      return run(SmallEquations<4>(a));
    case 5:
      return run(SmallEquations<5>(a));
    case 6:
      return run(SmallEquations<6>(a));
    case 7:
      return run(SmallEquations<7>(a));
    case 8:
      return run(SmallEquations<8>(a));
    default:
      return with_large_equations(a, body);
  }
}

/// out = y + sum_{j < count} c[j] k_j in one pass, k_j = k + j * stride; y may be null (0).
void combine_large(size_t n, double* out, const double* y, const double* c, const double* k, size_t stride,
                   size_t count);
/// The same over all components of the equations' arrays, k_j = array first + j.
template <class Equations>
void combine(Equations& eq, double* out, const double* y, const double* c, size_t first, size_t count) {
  if constexpr (requires { typename std::integral_constant<size_t, Equations::padded()>; }) {
    constexpr size_t kWidth = Equations::padded();
    double sum[kWidth];
    for (size_t i = 0; i < kWidth; ++i) sum[i] = y ? y[i] : 0;
    const double* k = eq.array(first);
    for (size_t j = 0; j < count; ++j) {
#pragma GCC unroll 8
      for (size_t i = 0; i < kWidth; ++i) sum[i] += c[j] * k[j * kWidth + i];
    }
    for (size_t i = 0; i < kWidth; ++i) out[i] = sum[i];
  } else {
    combine_large(eq.size(), out, y, c, eq.array(first), size_t(eq.array(1) - eq.array(0)), count);
  }
}
}  // namespace truestep
