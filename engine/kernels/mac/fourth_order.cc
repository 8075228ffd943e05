#include "engine/kernels/mac/fourth_order.h"

namespace truestep::mac {

namespace {
// f points at the value after the point, s is the stride to the next value.
double between(const double* f, size_t s) {
  return 0.5625 * (*(f - s) + f[0]) - 0.0625 * (*(f - 2 * s) + f[s]);
}
}  // namespace

void momentum_rate4(const MacGrid& g, size_t c, const ConstFields& u, double viscosity, double* out,
                    const ThreadArena& arena) {
  const size_t sc = g.stride(c);
  for_rows(g, c, arena, [&](size_t at, size_t, size_t, size_t n) {
    double* to = out + at;
    for (size_t i = 0; i < n; ++i) to[i] = 0;
    for (size_t a = 0; a < g.dimensions; ++a) {
      const size_t s = g.stride(a);
      const double slope = 1 / (12 * g.spacing[a]), diffuse = viscosity / (12 * g.spacing[a] * g.spacing[a]);
      for (size_t i = 0; i < n; ++i) {
        const double* q = u[c] + at + i;
        const double first = q[s] - *(q - s), second = q[2 * s] - *(q - 2 * s);
        double carry = q[0];
        if (a != c) {
          const double* w = u[a] + at + i;
          carry = 0.5625 * (between(w, sc) + between(w + s, sc)) -
                  0.0625 * (between(w - s, sc) + between(w + 2 * s, sc));
        }
        to[i] += diffuse * (16 * (q[s] + *(q - s)) - 30 * q[0] - (q[2 * s] + *(q - 2 * s))) -
                 slope * carry * (8 * first - second);
      }
    }
  });
}

void add_laplacian4(const MacGrid& g, size_t place, const double* u, double factor, double* out,
                    const ThreadArena& arena) {
  for_rows(g, place, arena, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t a = 0; a < g.dimensions; ++a) {
      const size_t s = g.stride(a);
      const double scale = factor / (12 * g.spacing[a] * g.spacing[a]);
      for (size_t i = at; i < at + n; ++i)
        out[i] += scale * (16 * (u[i + s] + u[i - s]) - 30 * u[i] - (u[i + 2 * s] + u[i - 2 * s]));
    }
  });
}

double divergence4_at(const MacGrid& g, const ConstFields& u, size_t at) {
  double sum = 0;
  for (size_t a = 0; a < g.dimensions; ++a) {
    const size_t s = g.stride(a);
    const double* f = u[a] + at;
    sum += (1.125 * (f[s] - f[0]) - (f[2 * s] - *(f - s)) / 24) / g.spacing[a];
  }
  return sum;
}

void divergence4(const MacGrid& g, const ConstFields& u, double* out, const ThreadArena& arena) {
  for_rows(g, kCentre, arena, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) out[i] = divergence4_at(g, u, i);
  });
}

void flow_through4(const MacGrid& g, size_t c, const double* u, double* out, const ThreadArena& arena) {
  const size_t s = g.stride(c);
  for_rows(g, c, arena, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i) out[i] = 1.125 * u[i] - (u[i - s] + u[i] + u[i + s]) / 24;
  });
}

void subtract_gradient4(const MacGrid& g, size_t c, const double* p, double factor, double* u,
                        const ThreadArena& arena) {
  const double scale = factor / g.spacing[c];
  const size_t s = g.stride(c);
  for_rows(g, c, arena, [&](size_t at, size_t, size_t, size_t n) {
    for (size_t i = at; i < at + n; ++i)
      u[i] -= scale * (1.125 * (p[i] - p[i - s]) - (p[i + s] - p[i - 2 * s]) / 24);
  });
}

}  // namespace truestep::mac
