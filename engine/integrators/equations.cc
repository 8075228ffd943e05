#include "engine/integrators/equations.h"

#include "engine/integrators/large_equations.h"
#include "engine/integrators/small_equations.h"

namespace truestep {

Equations::~Equations() {
  if (!a_.statistics) return;
  a_.statistics->rates += count_.rates, a_.statistics->jacobians += count_.jacobians;
  a_.statistics->factorisations += count_.factorisations, a_.statistics->solves += count_.solves;
}

double Equations::norm(const double* e, const double* y, const double* z) const {
  return weighted_norm(a_.tolerance, n_, e, y, z);
}

void with_equations(Advance& a, const std::function<void(Equations&)>& body) {
  const auto run = [&](auto&& equations) { body(equations); };
  static_assert(kSmallest == 8);
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
      return run(LargeEquations(a));
  }
}

namespace {
template <size_t K>
void combine_terms(size_t n, double* out, const double* y, const double* c, const double* k, size_t stride) {
#pragma GCC ivdep
  for (size_t i = 0; i < n; ++i) {
    double sum = y ? y[i] : 0;
#pragma GCC unroll 8
    for (size_t j = 0; j < K; ++j) sum += c[j] * k[j * stride + i];
    out[i] = sum;
  }
}
}  // namespace

void combine(size_t n, double* out, const double* y, const double* c, const double* k, size_t stride,
             size_t count) {
  using Kernel = void (*)(size_t, double*, const double*, const double*, const double*, size_t);
  static constexpr Kernel kKernels[] = {combine_terms<0>, combine_terms<1>, combine_terms<2>,
                                        combine_terms<3>, combine_terms<4>, combine_terms<5>,
                                        combine_terms<6>, combine_terms<7>, combine_terms<8>};
  kKernels[count](n, out, y, c, k, stride);
}

}  // namespace truestep
