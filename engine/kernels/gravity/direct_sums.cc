#include "engine/kernels/gravity/direct_sums.h"

#include <algorithm>

namespace truestep::gravity {

namespace {

constexpr size_t kUnit = 8;        // bodies side by side
constexpr size_t kBlock = 64;      // bodies whose own pairs are computed both ways
constexpr size_t kTile = 256;      // bodies whose columns stay in the first-level cache
constexpr size_t kMostStrips = 8;  // shares of the work with separate sums
constexpr double kTiny = 1e-180;   // m^2; the third power of its root, times a mass, is still a normal number

size_t filled(size_t n) {
  return (n + kUnit - 1) / kUnit * kUnit;
}

PairColumns columns(const Bodies& bodies, DirectScratch& scratch) {
  const size_t n = bodies.size(), rows = filled(n);
  if (scratch.columns.size() < 4 * rows) scratch.columns.resize(4 * rows);
  double* c = scratch.columns.data();
  for (size_t i = 0; i < rows; ++i) {
    const size_t from = std::min(i, n - 1);
    for (size_t k = 0; k < 3; ++k) c[k * rows + i] = bodies.x[3 * from + k];
    c[3 * rows + i] = i < n ? bodies.mu[i] : 0;
  }
  return {c, c + rows, c + 2 * rows, c + 3 * rows, nullptr, nullptr, nullptr};
}

/// pair(i0, i1, j0, j1) and self(i0, i1) for all pairs assigned to the strip.
template <class Pair, class Self>
void for_strip(size_t rows, size_t strip, size_t strips, const Pair& pair, const Self& self) {
  const size_t blocks = (rows + kBlock - 1) / kBlock;
  // Alternating direction, because later blocks have fewer others after them.
  const auto strip_of = [strips](size_t block) {
    const size_t at = block % (2 * strips);
    return at < strips ? at : 2 * strips - 1 - at;
  };
  for (size_t tile = 0; tile < rows; tile += kTile) {
    const size_t end = std::min(tile + kTile, rows);
    for (size_t b = 0; b < blocks && b * kBlock < end; ++b) {
      if (strip_of(b) != strip) continue;
      const size_t i0 = b * kBlock, i1 = std::min(i0 + kBlock, rows);
      if (i0 >= tile) self(i0, i1);
      if (std::max(i1, tile) < end) pair(i0, i1, std::max(i1, tile), end);
    }
  }
}

size_t strips_of(size_t rows) {
  return std::clamp<size_t>(rows / (4 * kBlock), 1, kMostStrips);
}

}  // namespace

void direct_accelerations(const Bodies& bodies, const Softening& softening, std::span<double> a,
                          DirectScratch& scratch, const ThreadArena& arena) {
  const DirectLoops& loops = softening.loops(pair_loops()).direct;
  const LawNumbers law{softening.length, kTiny};
  const size_t n = bodies.size(), rows = filled(n), strips = strips_of(rows);
  const PairColumns base = columns(bodies, scratch);
  if (scratch.sums.size() < 3 * rows * strips) scratch.sums.resize(3 * rows * strips);
  arena.for_blocks(strips, 1, [&](size_t strip, size_t) {
    PairColumns c = base;
    double* own = scratch.sums.data() + 3 * rows * strip;
    std::fill_n(own, 3 * rows, 0.0);
    c.ax = own, c.ay = own + rows, c.az = own + 2 * rows;
    for_strip(
        rows, strip, strips,
        [&](size_t i0, size_t i1, size_t j0, size_t j1) { loops.cross(c, law, i0, i1, j0, j1); },
        [&](size_t i0, size_t i1) { loops.own(c, law, i0, i1); });
  });
  for (size_t k = 0; k < 3; ++k) {
    for (size_t i = 0; i < n; ++i) {
      double total = 0;
      for (size_t s = 0; s < strips; ++s) total += scratch.sums[(3 * s + k) * rows + i];
      a[3 * i + k] = total;
    }
  }
}

double direct_potential(const Bodies& bodies, const Softening& softening, DirectScratch& scratch,
                        const ThreadArena& arena) {
  const DirectLoops& loops = softening.loops(pair_loops()).direct;
  const LawNumbers law{softening.length, kTiny};
  const size_t rows = filled(bodies.size()), strips = strips_of(rows);
  const PairColumns c = columns(bodies, scratch);
  return arena.sum_blocks(strips, 1, [&](size_t strip, size_t) {
    double total = 0;
    for_strip(
        rows, strip, strips,
        [&](size_t i0, size_t i1, size_t j0, size_t j1) {
          for (size_t i = i0; i < i1; ++i) total += c.mu[i] * loops.potential(c, law, i, j0, j0, j1);
        },
        [&](size_t i0, size_t i1) {
          for (size_t i = i0; i < i1; ++i) total += c.mu[i] * loops.potential(c, law, i, i + 1, i0, i1);
        });
    return total;
  });
}

}  // namespace truestep::gravity
