#include "engine/kernels/mac/stream_function.h"

namespace truestep::mac {

namespace {

// Weight of place k of N in the value at x of the Lagrange polynomial through them.
template <size_t N>
constexpr double lagrange(const std::array<double, N>& at, size_t k, double x) {
  double w = 1;
  for (size_t j = 0; j < N; ++j) {
    if (j != k) w *= (x - at[j]) / (at[k] - at[j]);
  }
  return w;
}

// Along a side: the side itself at 0, and four cells.
constexpr std::array<double, 5> kCells{0, 0.5, 1.5, 2.5, 3.5};
// Towards a side with value 0 and a known slope: x^2 times the parabola through three places.
constexpr std::array<double, 3> kInside{1, 2, 3};

// `cell` is the last one inside.
void continue_cells(double* cell, ptrdiff_t inwards, const Edge& edge) {
  for (ptrdiff_t m = 1; m <= static_cast<ptrdiff_t>(kGhosts); ++m) {
    if (edge.kind == Edge::Kind::slide) {
      cell[-m * inwards] = cell[(m - 1) * inwards];
      continue;
    }
    const double x = 0.5 - static_cast<double>(m);
    double value = lagrange(kCells, 0, x) * edge.velocity;
    for (size_t k = 1; k < kCells.size(); ++k)
      value += lagrange(kCells, k, x) * cell[static_cast<ptrdiff_t>(k - 1) * inwards];
    cell[-m * inwards] = value;
  }
}

// `face` lies on the side, where its value is 0; `slope` is per spacing, inwards.
void continue_faces(double* face, ptrdiff_t inwards, const Edge& edge, double slope, ptrdiff_t most) {
  for (ptrdiff_t m = 1; m <= most; ++m) {
    if (edge.kind == Edge::Kind::slide) {
      face[-m * inwards] = -face[m * inwards];
      continue;
    }
    const auto x = -static_cast<double>(m);
    double value = slope * x;
    for (size_t k = 0; k < kInside.size(); ++k) {
      const double there = face[static_cast<ptrdiff_t>(k + 1) * inwards] - slope * kInside[k];
      value += lagrange(kInside, k, x) * x * x / (kInside[k] * kInside[k]) * there;
    }
    face[-m * inwards] = value;
  }
}

// f(offset of node (0, j), j) for the nodes' rows.
template <class F>
void for_node_rows(const MacGrid& g, const ThreadArena& arena, size_t first, size_t last, F&& f) {
  const size_t block = 1 + kBlockRows / (g.cells[0] + 1);
  arena.for_blocks(last - first, block, [&](size_t begin, size_t end) {
    for (size_t j = first + begin; j < first + end; ++j) f(g.at(0, j, 0), j);
  });
}

// Slope at the node after the first of four values midway between nodes.
double slope_beside(const double* first, ptrdiff_t step) {
  return (-23 * first[0] + 21 * first[step] + 3 * first[2 * step] - first[3 * step]) / 24;
}
double slope_between(const double* after, ptrdiff_t step) {
  return 1.125 * (after[0] - after[-step]) - (after[step] - after[-2 * step]) / 24;
}
// The same if there are two values on each side of node i of n.
double slope_at(const double* after, ptrdiff_t step, size_t i, size_t n) {
  if (i == 1) return slope_beside(after - step, step);
  if (i + 1 == n) return -slope_beside(after, -step);
  return slope_between(after, step);
}

}  // namespace

void velocity_of_stream(const MacGrid& g, const double* psi, const Fields& u, const ThreadArena& arena) {
  const size_t s = g.stride(1), nx = g.cells[0], ny = g.cells[1];
  const double across = 1 / g.spacing[1], along = 1 / g.spacing[0];
  for_node_rows(g, arena, 0, ny + 1, [&](size_t at, size_t j) {
    const double* p = psi + at;
    double *x = u[0] + at, *y = u[1] + at;
    if (j < ny) {
      for (size_t i = 0; i <= nx; ++i) x[i] = across * (p[i + s] - p[i]);
    }
    for (size_t i = 0; i < nx; ++i) y[i] = along * (p[i] - p[i + 1]);
  });
}

void velocity_of_stream4(const MacGrid& g, const Edges& edges, double* psi, const Fields& u,
                         const ThreadArena& arena) {
  const size_t nx = g.cells[0], ny = g.cells[1];
  const auto s = static_cast<ptrdiff_t>(g.stride(1));
  // dpsi/dx = -v at the sides of x, dpsi/dy = u at those of y.
  for (size_t j = 1; j < ny; ++j) {
    double* row = psi + g.at(0, j, 0);
    continue_faces(row, 1, edges[0][0], -edges[0][0].velocity * g.spacing[0], 1);
    continue_faces(row + nx, -1, edges[0][1], edges[0][1].velocity * g.spacing[0], 1);
  }
  for (size_t i = 1; i < nx; ++i) {
    double* column = psi + g.at(i, 0, 0);
    continue_faces(column, s, edges[1][0], edges[1][0].velocity * g.spacing[1], 1);
    continue_faces(column + static_cast<ptrdiff_t>(ny) * s, -s, edges[1][1],
                   -edges[1][1].velocity * g.spacing[1], 1);
  }
  const double across = 1 / g.spacing[1], along = -1 / g.spacing[0];
  for_node_rows(g, arena, 0, ny + 1, [&](size_t at, size_t j) {
    const double* p = psi + at;
    double *x = u[0] + at, *y = u[1] + at;
    if (j < ny) {
      for (size_t i = 1; i < nx; ++i) x[i] = across * slope_between(p + i + s, s);
      x[0] = x[nx] = 0;
    }
    const bool side = j == 0 || j == ny;
    for (size_t i = 0; i < nx; ++i) y[i] = side ? 0 : along * slope_between(p + i + 1, 1);
  });
}

void fill_ghosts4(const MacGrid& g, size_t c, const Edges& edges, double* u) {
  for (size_t a = 0; a < 2; ++a) {
    const size_t other = 1 - a;
    const auto step = static_cast<ptrdiff_t>(g.stride(a));
    const auto n = static_cast<ptrdiff_t>(g.cells[a]);
    for (size_t p = 0; p < g.padded(other); ++p) {
      double* line = u + p * g.stride(other) + kGhosts * g.stride(a);
      if (a == c) {
        // The slope along the normal is that of the velocity along the side, which is constant.
        continue_faces(line, step, edges[a][0], 0, kGhosts);
        continue_faces(line + n * step, -step, edges[a][1], 0, kGhosts);
      } else {
        continue_cells(line, step, edges[a][0]);
        continue_cells(line + (n - 1) * step, -step, edges[a][1]);
      }
    }
  }
}

void curl_of_rate(const MacGrid& g, const ConstFields& rate, double* out, const ThreadArena& arena) {
  const size_t s = g.stride(1), nx = g.cells[0];
  const double across = 1 / g.spacing[1], along = 1 / g.spacing[0];
  for_node_rows(g, arena, 1, g.cells[1], [&](size_t at, size_t) {
    const double *x = rate[0] + at, *below = x - s, *y = rate[1] + at;
    for (size_t i = 1; i < nx; ++i) out[at + i] = along * (y[i] - y[i - 1]) - across * (x[i] - below[i]);
  });
}

void curl_of_rate4(const MacGrid& g, const ConstFields& rate, double* out, const ThreadArena& arena) {
  const size_t nx = g.cells[0], ny = g.cells[1];
  const auto s = static_cast<ptrdiff_t>(g.stride(1));
  const double across = 1 / g.spacing[1], along = 1 / g.spacing[0];
  for_node_rows(g, arena, 1, ny, [&](size_t at, size_t j) {
    const double *x = rate[0] + at, *y = rate[1] + at;
    for (size_t i = 1; i < nx; ++i)
      out[at + i] = along * slope_at(y + i, 1, i, nx) - across * slope_at(x + i, s, j, ny);
  });
}

}  // namespace truestep::mac
