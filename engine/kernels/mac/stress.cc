#include "engine/kernels/mac/stress.h"

namespace truestep::mac {

void add_stress(const MacGrid& g, size_t c, const ConstFields& u, const double* fluidity,
                const double* lightness, double density, double* rate, const ThreadArena& arena) {
  const size_t sc = g.stride(c);
  for_rows(g, c, arena, [&](size_t at, size_t, size_t, size_t n) {
    const double* q = u[c];
    for (size_t i = at; i < at + n; ++i) {
      double sum = 0;
      for (size_t a = 0; a < g.dimensions; ++a) {
        const size_t s = g.stride(a);
        if (a == c) {
          const double high = (q[i + s] - q[i]) / fluidity[i], low = (q[i] - q[i - s]) / fluidity[i - s];
          sum += 2 * (high - low) / (g.spacing[a] * g.spacing[a]);
          continue;
        }
        // Along the edge between the cells of the face and the next ones.
        const auto edge = [&](size_t before) {
          const size_t after = before + s;
          const double shear =
              (q[after] - q[before]) / g.spacing[a] + (u[a][after] - u[a][after - sc]) / g.spacing[c];
          return 4 * shear /
                 (fluidity[before] + fluidity[before - sc] + fluidity[after] + fluidity[after - sc]);
        };
        sum += (edge(i) - edge(i - s)) / g.spacing[a];
      }
      rate[i] += sum * lightness[i] / density;
    }
  });
}

}  // namespace truestep::mac
