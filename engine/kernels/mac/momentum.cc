#include "engine/kernels/mac/momentum.h"

namespace truestep::mac {

void momentum_rate(const MacGrid& g, size_t c, const ConstFields& u, double viscosity, double* out,
                   const ThreadArena& arena) {
  const size_t sc = g.stride(c);
  for_rows(g, c, arena, [&](size_t at, size_t, size_t, size_t n) {
    const double* q = u[c] + at;
    double* to = out + at;
    {
      const double flux = 0.25 / g.spacing[c], diffuse = viscosity / (g.spacing[c] * g.spacing[c]);
      const double *after = q + sc, *before = q - sc;
#pragma GCC ivdep
      for (size_t i = 0; i < n; ++i) {
        const double high = q[i] + after[i], low = before[i] + q[i];
        to[i] = flux * (low * low - high * high) + diffuse * (after[i] - 2 * q[i] + before[i]);
      }
    }
    for (size_t a = 0; a < g.dimensions; ++a) {
      if (a == c) continue;
      const size_t sa = g.stride(a);
      const double flux = 0.25 / g.spacing[a], diffuse = viscosity / (g.spacing[a] * g.spacing[a]);
      const double *after = q + sa, *before = q - sa, *w = u[a] + at;
      const double *w_before = w - sc, *w_high = w + sa, *w_high_before = w_high - sc;
#pragma GCC ivdep
      for (size_t i = 0; i < n; ++i) {
        const double high = (q[i] + after[i]) * (w_high[i] + w_high_before[i]);
        const double low = (before[i] + q[i]) * (w[i] + w_before[i]);
        to[i] += flux * (low - high) + diffuse * (after[i] - 2 * q[i] + before[i]);
      }
    }
  });
}

void add_laplacian(const MacGrid& g, size_t place, const double* u, double factor, double* out,
                   const ThreadArena& arena) {
  for_rows(g, place, arena, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t a = 0; a < g.dimensions; ++a) {
      const double scale = factor / (g.spacing[a] * g.spacing[a]);
      const double *q = u + at, *after = q + g.stride(a), *before = q - g.stride(a);
#pragma GCC ivdep
      for (size_t i = 0; i < n; ++i) out[at + i] += scale * (after[i] - 2 * q[i] + before[i]);
    }
  });
}

void divergence(const MacGrid& g, const ConstFields& u, double* out, const ThreadArena& arena) {
  for_rows(g, kCentre, arena, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = 0; i < n; ++i) out[at + i] = 0;
    for (size_t a = 0; a < g.dimensions; ++a) {
      const double scale = 1 / g.spacing[a];
      const double *low = u[a] + at, *high = low + g.stride(a);
#pragma GCC ivdep
      for (size_t i = 0; i < n; ++i) out[at + i] += scale * (high[i] - low[i]);
    }
  });
}

void subtract_gradient(const MacGrid& g, size_t c, const double* p, double factor, double* u,
                       const ThreadArena& arena) {
  const double scale = factor / g.spacing[c];
  for_rows(g, c, arena, [&](size_t at, size_t, size_t, size_t n) {
    const double *high = p + at, *low = high - g.stride(c);
#pragma GCC ivdep
    for (size_t i = 0; i < n; ++i) u[at + i] -= scale * (high[i] - low[i]);
  });
}

}  // namespace truestep::mac
