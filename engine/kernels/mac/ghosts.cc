#include "engine/kernels/mac/ghosts.h"

namespace truestep::mac {

namespace {

// Along the normal of the side: face n is the side. `inwards` is the stride to the next face inside.
void normal_end(double* face, ptrdiff_t inwards, const SideValues& side, size_t plane) {
  if (side.mirror == Mirror::given) {
    const double g = side.at(plane);
    face[0] = g;
    for (ptrdiff_t m = 1; m <= static_cast<ptrdiff_t>(kGhosts); ++m)
      face[-m * inwards] = 2 * g - face[m * inwards];
  } else {
    for (ptrdiff_t m = 1; m <= static_cast<ptrdiff_t>(kGhosts); ++m) face[-m * inwards] = face[0];
  }
}

// `cell` is the last one inside; the side lies half a spacing before it. The first value beyond a side with a
// given value is that of the parabola through the side and two cells: with the mirror image, the wall's
// friction would have an error of the order of the slope's change.
void tangential_end(double* cell, ptrdiff_t inwards, const SideValues& side, size_t plane, size_t ghosts) {
  const bool given = side.mirror == Mirror::given;
  const double g = given ? side.at(plane) : 0, sign = given || side.mirror == Mirror::odd ? -1 : 1;
  for (size_t m = 0; m < ghosts; ++m) {
    const auto k = static_cast<ptrdiff_t>(m);
    cell[-(k + 1) * inwards] = 2 * g + sign * cell[k * inwards];
  }
  if (!given) return;
  cell[-inwards] = (8 * g - 6 * cell[0] + cell[inwards]) / 3;
}

}  // namespace

void fill_ghosts(const MacGrid& g, size_t place, const Sides& sides, double* u, const ThreadArena& arena) {
  for (size_t a = 0; a < g.dimensions; ++a) {
    const size_t first = a == 0 ? 1 : 0, second = a == 2 ? 1 : 2;
    const size_t rows = g.padded(first), planes = g.padded(second);
    const auto stride = static_cast<ptrdiff_t>(g.stride(a));
    const size_t n = g.cells[a];
    const auto last = static_cast<ptrdiff_t>(n);
    arena.for_blocks(planes, 4, [&](size_t begin, size_t end) {
      for (size_t q = begin; q < end; ++q) {
        for (size_t p = 0; p < rows; ++p) {
          double* line = u + p * g.stride(first) + q * g.stride(second) + kGhosts * g.stride(a);
          const size_t plane = p + rows * q;
          if (sides[a][0].mirror == Mirror::periodic) {
            for (ptrdiff_t m = 0; m <= static_cast<ptrdiff_t>(kGhosts); ++m)
              line[(last + m) * stride] = line[m * stride];
            for (ptrdiff_t m = 1; m <= static_cast<ptrdiff_t>(kGhosts); ++m)
              line[-m * stride] = line[(last - m) * stride];
          } else if (place == a) {
            normal_end(line, stride, sides[a][0], plane);
            normal_end(line + last * stride, -stride, sides[a][1], plane);
          } else {
            tangential_end(line, stride, sides[a][0], plane, kGhosts);
            tangential_end(line + (last - 1) * stride, -stride, sides[a][1], plane, kGhosts + 1);
          }
        }
      }
    });
  }
}

void add_wall_curvature(const MacGrid& g, size_t place, const Sides& sides, const double* change,
                        double factor, double* out, const ThreadArena& arena) {
  for (size_t a = 0; a < g.dimensions; ++a) {
    if (a == place) continue;
    const size_t first = a == 0 ? 1 : 0, second = a == 2 ? 1 : 2;
    const size_t rows = g.count(place, first), planes = g.count(place, second);
    const size_t s_first = g.stride(first), s_second = second < g.dimensions ? g.stride(second) : 0;
    const double scale = factor / (g.spacing[a] * g.spacing[a]);
    for (size_t end = 0; end < 2; ++end) {
      if (sides[a][end].mirror != Mirror::given) continue;
      const auto stride = static_cast<ptrdiff_t>(g.stride(a)), inwards = end == 0 ? stride : -stride;
      const size_t wall = g.base() + (end == 0 ? 0 : (g.cells[a] - 1) * g.stride(a));
      arena.for_blocks(planes, 4, [&](size_t begin, size_t last) {
        for (size_t q = begin; q < last; ++q) {
          for (size_t p = 0; p < rows; ++p) {
            const size_t at = wall + p * s_first + q * s_second;
            const double* cell = change + at;
            out[at] += scale * (cell[inwards] / 3 - cell[0]);
          }
        }
      });
    }
  }
}

}  // namespace truestep::mac
