// Impulses from a linear system by conjugate gradients (Saad 2003, algorithm 6.18): A y = right for a
// symmetric positive semidefinite A, three numbers per link, starting from y = 0.
#pragma once
#include <span>

#include "engine/core/state/workspace.h"
#include "engine/math/vec3.h"

namespace truestep {

struct GradientLimits {
  double accuracy = 0;  ///< relative residual at which it stops
  size_t iterations = 0;
};

/// y, 3 n numbers in `memory`. right(k): right-hand side of link k; apply(d): evaluates the effect of
/// impulses along d; product(k, d_k): link k of A d after that.
template <class Right, class Apply, class Product>
std::span<double> conjugate_gradients(size_t n, Workspace& memory, const GradientLimits& limits, Right right,
                                      Apply apply, Product product) {
  const auto y = memory.doubles("cg.y", 3 * n), r = memory.doubles("cg.r", 3 * n),
             d = memory.doubles("cg.d", 3 * n), q = memory.doubles("cg.q", 3 * n);
  double rr = 0;
  for (size_t k = 0; k < n; ++k) {
    const Vec3 b = right(k);
    store3(y.data(), k, Vec3{}), store3(r.data(), k, b), store3(d.data(), k, b);
    rr += norm2(b);
  }
  const double enough = limits.accuracy * limits.accuracy * rr;
  for (size_t iteration = 0; iteration < limits.iterations && rr > enough; ++iteration) {
    apply(d);
    double dq = 0;
    for (size_t k = 0; k < n; ++k) {
      const Vec3 dk = load3(d.data(), k), qk = product(k, dk);
      store3(q.data(), k, qk);
      dq += dot(dk, qk);
    }
    // Nothing yields in this direction: the equation cannot be satisfied there.
    if (!(dq > 0)) break;
    const double alpha = rr / dq, before = rr;
    rr = 0;
    for (size_t k = 0; k < 3 * n; ++k) {
      y[k] += alpha * d[k], r[k] -= alpha * q[k];
      rr += r[k] * r[k];
    }
    for (size_t k = 0; k < 3 * n; ++k) d[k] = r[k] + rr / before * d[k];
  }
  return y;
}

}  // namespace truestep
