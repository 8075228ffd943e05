// The equations of an integration where there are N <= 8 of them: arrays in the object itself, dense factors
// in one or two cache lines, loops unrolled. A method that is a template over the class of its equations can
// be compiled for sizes at which a benchmark shows that it pays: visit_equations.
#pragma once
#include "engine/integrators/equations.h"
#include "engine/math/solvers/small_lu.h"

namespace truestep {

namespace detail {
/// J of at most kSmallest equations at (t, y), fy = f(t, y): element (i, j) at j * n + i.
void small_jacobian(Equations& eq, double t, const double* y, const double* fy, double* jacobian);
}  // namespace detail

/// What SmallEquations<N> hands to Equations; in whole vector registers.
template <int N>
struct SmallArrays {
  static constexpr size_t kPadded = N <= 2 ? N : (N + 3) / 4 * 4;
  alignas(64) std::array<std::array<double, kPadded>, kWorkArrays> arrays_{};
};

template <int N>
class SmallEquations final : private SmallArrays<N>, public Equations {
  using SmallArrays<N>::kPadded, SmallArrays<N>::arrays_;

 public:
  explicit SmallEquations(Advance& a) : Equations(a, kPadded, arrays_[0].data(), kPadded) {}

  // As in Equations, known to the compiler.
  static constexpr size_t size() { return N; }
  static constexpr size_t padded() { return kPadded; }
  double* array(size_t k) { return arrays_[k].data(); }
  double norm(const double* e, const double* y, const double* z) const {
    return weighted_norm(a_.tolerance, N, e, y, z);
  }

  void differentiate(double t, const double* y, const double* fy) override {
    detail::small_jacobian(*this, t, y, fy, jacobian_.data());
  }
  bool factor(double z) override { return fill_and_factor(real_, z); }
  bool factor(Complex z) override { return fill_and_factor(complex_, z); }
  void solve(double* b) override {
    ++count_.solves;
    real_.solve(b);
  }
  void solve(double* re, double* im) override {
    ++count_.solves;
    Complex b[N];
    for (int i = 0; i < N; ++i) b[i] = {re[i], im[i]};
    complex_.solve(b);
    for (int i = 0; i < N; ++i) re[i] = b[i].re, im[i] = b[i].im;
  }

 private:
  template <class T>
  bool fill_and_factor(SmallLu<T, N>& lu, T z) {
    ++count_.factorisations;
    T* m = lu.matrix();
#pragma GCC unroll 64
    for (int k = 0; k < N * N; ++k) m[k] = T(0) - jacobian_[size_t(k)] * z;
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) m[k * N + k] += T(1);
    return lu.factor();
  }

  std::array<double, size_t(N* N)> jacobian_;
  SmallLu<double, N> real_;
  SmallLu<Complex, N> complex_;
};

extern template class SmallEquations<1>;
extern template class SmallEquations<2>;
extern template class SmallEquations<3>;
extern template class SmallEquations<4>;
extern template class SmallEquations<5>;
extern template class SmallEquations<6>;
extern template class SmallEquations<7>;
extern template class SmallEquations<8>;

template <int N>
void combine(SmallEquations<N>& eq, double* out, const double* y, const double* c, size_t first,
             size_t count) {
  constexpr size_t kWidth = SmallEquations<N>::padded();
  double sum[kWidth];
  for (size_t i = 0; i < kWidth; ++i) sum[i] = y ? y[i] : 0;
  const double* k = eq.array(first);
  for (size_t j = 0; j < count; ++j) {
#pragma GCC unroll 8
    for (size_t i = 0; i < kWidth; ++i) sum[i] += c[j] * k[j * kWidth + i];
  }
  for (size_t i = 0; i < kWidth; ++i) out[i] = sum[i];
}

/// body(equations) with SmallEquations<N> for the numbers of equations named, with Equations for all others.
template <int... N, class Body>
void visit_equations(Advance& a, Body body) {
  const auto small = [&]<int M>() {
    SmallEquations<M> equations(a);
    body(equations);
  };
  const bool named = ((a.f.size() == N && (small.template operator()<N>(), true)) || ...);
  if (!named) with_equations(a, std::ref(body));
}

}  // namespace truestep
