// Right-hand sides on the staggered grid by central differences of second order: convection in divergence
// form after Harlow and Welch (1965), which conserves kinetic energy where the divergence is zero (Morinishi
// et al. 1998, "Fully conservative higher order finite difference schemes", section 4), and the Laplacian.
// Ghosts must be filled.
#pragma once
#include <algorithm>
#include <array>

#include "engine/base/largest_block.h"
#include "engine/kernels/mac/mac_grid.h"

namespace truestep::mac {

using Fields = std::array<double*, 3>;
using ConstFields = std::array<const double*, 3>;

/// f(offset of the row's first value, its i, j, k, number of values) for every row of `place` along x, in
/// parallel.
template <class F>
void for_rows(const MacGrid& g, size_t place, const ThreadArena& arena, F&& f) {
  const size_t nx = g.count(place, 0), ny = g.count(place, 1), nz = g.count(place, 2);
  const size_t block = nx >= kBlockRows ? 1 : kBlockRows / nx;
  arena.for_blocks(ny * nz, block, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) f(g.at(0, r % ny, r / ny), r % ny, r / ny, nx);
  });
}

/// f(offset) for the start of every line along axis a, those through ghosts included, in parallel.
template <class F>
void for_lines(const MacGrid& g, size_t a, const ThreadArena& arena, F&& f) {
  constexpr size_t kLines = 512;
  const size_t first = a == 0 ? 1 : 0, second = a == 2 ? 1 : 2;
  const size_t n = g.padded(first), lines = n * g.padded(second);
  arena.for_blocks(lines, kLines, [&](size_t begin, size_t end) {
    for (size_t l = begin; l < end; ++l) f(l % n * g.stride(first) + l / n * g.stride(second));
  });
}

/// Largest of 0 and f(offset of the row's first value, number of values) over the rows of `place`.
template <class F>
double largest_of_rows(const MacGrid& g, size_t place, const ThreadArena& arena, F&& f) {
  const size_t nx = g.count(place, 0), ny = g.count(place, 1), nz = g.count(place, 2);
  const size_t block = nx >= kBlockRows ? 1 : kBlockRows / nx;
  return largest_block(arena, ny * nz, block, [&](size_t begin, size_t end) {
    double most = 0;
    for (size_t r = begin; r < end; ++r) {
      const double row = f(g.at(0, r % ny, r / ny), nx);
      most = row > most ? row : most;
    }
    return most;
  });
}

/// to = value everywhere, ghosts included.
template <class T>
void fill_all(const MacGrid& g, T value, T* to, const ThreadArena& arena) {
  arena.for_blocks(g.size(), kBlockRows,
                   [=](size_t begin, size_t end) { std::fill(to + begin, to + end, value); });
}
/// to = from everywhere, ghosts included.
inline void copy_all(const MacGrid& g, const double* from, double* to, const ThreadArena& arena) {
  arena.for_blocks(g.size(), kBlockRows,
                   [=](size_t begin, size_t end) { std::copy(from + begin, from + end, to + begin); });
}

/// out = -div(u u_c) + viscosity lap u_c at the faces of component c (m/s^2).
void momentum_rate(const MacGrid& grid, size_t c, const ConstFields& u, double viscosity, double* out,
                   const ThreadArena& arena);
/// out += factor lap u at any place.
void add_laplacian(const MacGrid& grid, size_t place, const double* u, double factor, double* out,
                   const ThreadArena& arena);
/// out = div u at the cells (1/s).
void divergence(const MacGrid& grid, const ConstFields& u, double* out, const ThreadArena& arena);
/// u_c -= factor dp/dx_c on the faces of component c.
void subtract_gradient(const MacGrid& grid, size_t c, const double* p, double factor, double* u,
                       const ThreadArena& arena);

}  // namespace truestep::mac
