#include "engine/kernels/mac/surface.h"

namespace truestep::mac {

void surface_faces(const MacGrid& g, size_t c, const uint8_t* liquid, const double* depth, double* factor,
                   const ThreadArena& arena) {
  const size_t s = g.stride(c), n = g.cells[c];
  for_rows(g, c, arena, [&](size_t at, size_t j, size_t k, size_t count) {
    const size_t along = c == 1 ? j : k;
    for (size_t i = 0; i < count; ++i) {
      const size_t high = at + i, low = high - s, place = c == 0 ? i : along;
      double f = 0;
      const bool side = !g.periodic[c] && (place == 0 || place == n);
      if (!side && (liquid[low] || liquid[high])) {
        f = liquid[low] && liquid[high] ? 1
            : liquid[low]               ? surface_factor(depth[low], depth[high])
                                        : surface_factor(depth[high], depth[low]);
      }
      factor[high] = f;
    }
  });
}

void extrapolate(const MacGrid& g, size_t c, int layers, double* u, uint8_t* known, double* found,
                 uint8_t* fresh, const ThreadArena& arena) {
  for (int layer = 0; layer < layers; ++layer) {
    wrap_periodic(g, u, arena), wrap_periodic(g, known, arena);
    for_rows(g, c, arena, [&](size_t at, size_t, size_t, size_t n) {
      for (size_t i = at; i < at + n; ++i) {
        fresh[i] = 0;
        if (known[i]) continue;
        double sum = 0;
        int count = 0;
        for (size_t a = 0; a < g.dimensions; ++a) {
          for (const size_t m : {i - g.stride(a), i + g.stride(a)}) {
            if (known[m]) sum += u[m], ++count;
          }
        }
        if (count > 0) found[i] = sum / count, fresh[i] = 1;
      }
    });
    for_rows(g, c, arena, [&](size_t at, size_t, size_t, size_t n) {
      for (size_t i = at; i < at + n; ++i) {
        if (fresh[i]) u[i] = found[i], known[i] = 1;
      }
    });
  }
}

void fold_periodic(const MacGrid& g, double* u, const ThreadArena& arena) {
  for (size_t a = 0; a < g.dimensions; ++a) {
    if (!g.periodic[a]) continue;
    const size_t s = g.stride(a), n = g.cells[a];
    for_lines(g, a, arena, [=](size_t at) {
      double* line = u + at;
      for (size_t m = 0; m < kGhosts; ++m) line[(n + m) * s] += line[m * s];
      for (size_t m = 0; m <= kGhosts; ++m) line[(kGhosts + m) * s] += line[(kGhosts + n + m) * s];
    });
  }
}

void fold_cells(const MacGrid& g, double* u, const ThreadArena& arena) {
  fold_periodic(g, u, arena);
  for (size_t a = 0; a < g.dimensions; ++a) {
    if (g.periodic[a]) continue;
    const size_t s = g.stride(a), first = kGhosts * s, last = (kGhosts + g.cells[a] - 1) * s;
    for_lines(g, a, arena, [=](size_t at) {
      double* line = u + at;
      line[first] += line[first - s], line[last] += line[last + s];
      line[first - s] = line[last + s] = 0;
    });
  }
}

}  // namespace truestep::mac
