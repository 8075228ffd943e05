#include "engine/math/solvers/tile_band_lu.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/math/wide.h"

namespace truestep {

namespace {
constexpr size_t kT = TileBandLu::kTile;
using Lanes = Wide<double>;

Lanes load(const double* p) {
  Lanes w;
  std::memcpy(&w.v, p, sizeof(w.v));
  return w;
}
void store(double* p, const Lanes& w) {
  std::memcpy(p, &w.v, sizeof(w.v));
}

// c = start - a b for tiles, row by row: 4 rows by 8 columns at a time stay in registers.
void subtract_product(const double* a, const double* b, const double* start, double* c) {
  for (size_t i = 0; i < kT; i += 4) {
    for (size_t j = 0; j < kT; j += 8) {
      Lanes sum[4][2];
      for (size_t r = 0; r < 4; ++r) {
        sum[r][0] = start ? load(start + (i + r) * kT + j) : Lanes::zero();
        sum[r][1] = start ? load(start + (i + r) * kT + j + 4) : Lanes::zero();
      }
      for (size_t k = 0; k < kT; ++k) {
        const Lanes b0 = load(b + k * kT + j), b1 = load(b + k * kT + j + 4);
        for (size_t r = 0; r < 4; ++r) {
          const Lanes x(a[(i + r) * kT + k]);
          sum[r][0] = nmadd(x, b0, sum[r][0]), sum[r][1] = nmadd(x, b1, sum[r][1]);
        }
      }
      for (size_t r = 0; r < 4; ++r) {
        store(c + (i + r) * kT + j, sum[r][0]), store(c + (i + r) * kT + j + 4, sum[r][1]);
      }
    }
  }
}

// y -= A x for a tile.
void subtract_tile(const double* a, const double* x, double* y) {
  for (size_t i = 0; i < kT; i += 4) {
    Lanes sum[4] = {Lanes::zero(), Lanes::zero(), Lanes::zero(), Lanes::zero()};
    for (size_t k = 0; k < kT; k += 4) {
      const Lanes b = load(x + k);
      for (size_t r = 0; r < 4; ++r) sum[r] = madd(load(a + (i + r) * kT + k), b, sum[r]);
    }
    for (size_t r = 0; r < 4; ++r) y[i + r] -= (sum[r][0] + sum[r][1]) + (sum[r][2] + sum[r][3]);
  }
}
}  // namespace

void TileBandLu::resize(size_t n, size_t diagonals) {
  n_ = n, blocks_ = (n + kTile - 1) / kTile;
  wide_ = std::min((diagonals + kTile - 1) / kTile, blocks_ - 1);
  across_ = 2 * wide_ + 1;
  a_.assign(blocks_ * across_ * kSize, 0);
  low_.resize(blocks_ * kSize), high_.resize(blocks_ * kSize);
  b_.assign(blocks_ * kTile, 0);
  for (size_t i = n; i < blocks_ * kTile; ++i) at(i, i) = 1;
}

double TileBandLu::bytes(double n, double diagonals) {
  return 8 * n * (kTile * (2 * std::ceil(diagonals / kTile) + 3) + 1);
}

// low = -L^-1 P and high = -U^-1 of the tile: negated, as products of tiles are subtracted.
bool TileBandLu::invert_diagonal(size_t k) {
  double* a = tile(k, k);
  double* low = low_.data() + k * kSize;
  double* high = high_.data() + k * kSize;
  std::fill_n(low, kSize, 0.0), std::fill_n(high, kSize, 0.0);
  for (size_t i = 0; i < kTile; ++i) low[i * kTile + i] = -1;
  for (size_t j = 0; j < kTile; ++j) {
    size_t p = j;
    for (size_t i = j + 1; i < kTile; ++i) {
      if (std::abs(a[i * kTile + j]) > std::abs(a[p * kTile + j])) p = i;
    }
    const double pivot = a[p * kTile + j];
    if (!(std::abs(pivot) > 0 && std::abs(pivot) < 1e300)) return false;
    if (p != j) {
      std::swap_ranges(a + p * kTile, a + (p + 1) * kTile, a + j * kTile);
      std::swap_ranges(low + p * kTile, low + (p + 1) * kTile, low + j * kTile);
    }
    for (size_t i = j + 1; i < kTile; ++i) {
      const double m = a[i * kTile + j] / pivot;
      if (m == 0) continue;
      for (size_t c = j + 1; c < kTile; ++c) a[i * kTile + c] -= m * a[j * kTile + c];
      for (size_t c = 0; c < kTile; ++c) low[i * kTile + c] -= m * low[j * kTile + c];
    }
  }
  // Rows of U^-1 from the last to the first.
  for (size_t i = kTile; i-- > 0;) {
    const double inverse = 1 / a[i * kTile + i];
    double* row = high + i * kTile;
    row[i] = -1;
    for (size_t m = i + 1; m < kTile; ++m) {
      const double u = a[i * kTile + m];
      for (size_t c = m; c < kTile; ++c) row[c] -= u * high[m * kTile + c];
    }
    for (size_t c = i; c < kTile; ++c) row[c] *= inverse;
  }
  return true;
}

bool TileBandLu::factor(const ThreadArena& arena) {
  for (size_t k = 0; k < blocks_; ++k) {
    if (!invert_diagonal(k)) return false;
    const size_t rest = std::min(wide_, blocks_ - 1 - k);
    if (rest == 0) continue;
    // Tiles below the diagonal times U^-1, tiles to its right times L^-1 P.
    arena.for_blocks(2 * rest, 4, [&](size_t begin, size_t end) {
      double old[kSize];
      for (size_t m = begin; m < end; ++m) {
        double* t = m < rest ? tile(k + 1 + m, k) : tile(k, k + 1 + m - rest);
        std::copy_n(t, kSize, old);
        if (m < rest) {
          subtract_product(old, high_.data() + k * kSize, nullptr, t);
        } else {
          subtract_product(low_.data() + k * kSize, old, nullptr, t);
        }
      }
    });
    arena.for_blocks(rest * rest, 16, [&](size_t begin, size_t end) {
      for (size_t m = begin; m < end; ++m) {
        const size_t i = k + 1 + m / rest, j = k + 1 + m % rest;
        double* t = tile(i, j);
        subtract_product(tile(i, k), tile(k, j), t, t);
      }
    });
  }
  return true;
}

void TileBandLu::solve(double* b) {
  std::copy_n(b, n_, b_.data());
  std::fill(b_.begin() + static_cast<ptrdiff_t>(n_), b_.end(), 0.0);
  double own[kTile];
  for (size_t k = 0; k < blocks_; ++k) {
    double* y = b_.data() + k * kTile;
    std::fill_n(own, kTile, 0.0);
    subtract_tile(low_.data() + k * kSize, y, own);
    std::copy_n(own, kTile, y);
    for (size_t i = k + 1; i <= std::min(k + wide_, blocks_ - 1); ++i)
      subtract_tile(tile(i, k), y, b_.data() + i * kTile);
  }
  for (size_t k = blocks_; k-- > 0;) {
    double* y = b_.data() + k * kTile;
    for (size_t j = k + 1; j <= std::min(k + wide_, blocks_ - 1); ++j)
      subtract_tile(tile(k, j), b_.data() + j * kTile, y);
    std::fill_n(own, kTile, 0.0);
    subtract_tile(high_.data() + k * kSize, y, own);
    std::copy_n(own, kTile, y);
  }
  std::copy_n(b_.data(), n_, b);
}

}  // namespace truestep
