// out = y + sum_j c_j k_j over flat arrays in one pass, for any number of terms known at run time: the
// linear combinations that Runge-Kutta stages consist of.
#pragma once
#include <array>
#include <cstddef>
#include <utility>

#include "engine/integrators/motion.h"

namespace truestep {

/// Terms of a linear combination; those with coefficient 0 are left out.
struct Combination {
  static constexpr size_t kMax = 14;
  std::array<double, kMax> c{};
  std::array<const double*, kMax> k{};
  size_t n = 0;
  void add(double coefficient, const double* array) {
    if (coefficient != 0) c[n] = coefficient, k[n] = array, ++n;
  }
};

namespace detail {
template <size_t N>
void combine_n(const Motion& m, size_t size, double* out, const double* y, const Combination& t) {
  const auto c = t.c;
  const auto k = t.k;
  m.loop(size, [out, y, c, k](size_t i) {
    double sum = y[i];
    for (size_t j = 0; j < N; ++j) sum += c[j] * k[j][i];
    out[i] = sum;
  });
}
}  // namespace detail

/// out = y + the combination; out may be y or one of the arrays.
inline void combine(const Motion& m, size_t size, double* out, const double* y, const Combination& t) {
  using Kernel = void (*)(const Motion&, size_t, double*, const double*, const Combination&);
  static constexpr auto kKernels = []<size_t... N>(std::index_sequence<N...>) {
    return std::array<Kernel, sizeof...(N)>{detail::combine_n<N>...};
  }
  (std::make_index_sequence<Combination::kMax + 1>());
  kKernels[t.n](m, size, out, y, t);
}

}  // namespace truestep
