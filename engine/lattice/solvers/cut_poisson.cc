#include "engine/lattice/solvers/cut_poisson.h"

#include <algorithm>
#include <cmath>

namespace truestep::lattice {

namespace {
void zero(size_t n, double* x, const ThreadArena& arena) {
  arena.for_blocks(n, kBlockRows, [x](size_t begin, size_t end) { std::fill(x + begin, x + end, 0.0); });
}
}  // namespace

void CutPoisson::wrap(const Level& l, double* x, const ThreadArena& arena) const {
  constexpr size_t kLines = 1024;
  for (size_t a = 0; a < grid_.dimensions; ++a) {
    if (!grid_.periodic[a]) continue;
    const size_t first = a == 0 ? 1 : 0, second = a == 2 ? 1 : 2, s = l.stride(a), n = l.n[first];
    arena.for_blocks(n * l.n[second], kLines, [&](size_t begin, size_t end) {
      for (size_t r = begin; r < end; ++r) {
        double* line = x + l.base + r % n * l.stride(first) + r / n * l.stride(second);
        line[-static_cast<ptrdiff_t>(s)] = line[(l.n[a] - 1) * s];
        line[l.n[a] * s] = line[0];
      }
    });
  }
}

void CutPoisson::relax_row(const Level& l, size_t colour, From from, const double* b, double* x, size_t j,
                           size_t q) const {
  const size_t s1 = l.stride(1), s2 = l.stride(2), at = l.at(0, j, q), end = at + l.n[0];
  const size_t begin = at + (colour + j + q) % 2;
  if (from == From::zero) {
    // As if 0 had been added, which is what a negative zero would show.
#pragma GCC ivdep
    for (size_t i = begin; i < end; i += 2) x[i] = l.inverse[i] * (b[i] + 0.0);
    return;
  }
  const bool space = grid_.dimensions == 3;
  const double *k0 = l.k[0].data(), *k1 = l.k[1].data(), *k2 = space ? l.k[2].data() : nullptr;
#pragma GCC ivdep
  for (size_t i = begin; i < end; i += 2) {
    double sum = b[i] + k0[i] * x[i + 1] + k0[i - 1] * x[i - 1] + k1[i] * x[i + s1] + k1[i - s1] * x[i - s1];
    if (space) sum += k2[i] * x[i + s2] + k2[i - s2] * x[i - s2];
    x[i] = l.inverse[i] * sum;
  }
}

// Layers across the last axis in blocks: the second colour follows the first one layer behind, while what
// both read is still in the cache, except in the layers at either end of a block, which need the neighbouring
// block's first colour. Any order within a colour gives the same bits.
void CutPoisson::relax(const Level& l, size_t first, From from, const double* b, double* x,
                       const ThreadArena& arena) const {
  const size_t last_axis = grid_.dimensions - 1, layers = l.n[last_axis];
  constexpr size_t kLayers = 8;
  const size_t most = std::max(kLayers, 4 * kBlockRows / (l.n[0] * (last_axis == 2 ? l.n[1] : 1)));
  // As even as they come: a coarse level has few blocks.
  const size_t blocks = (layers + most - 1) / most, block = (layers + blocks - 1) / blocks;
  const auto layer = [&](size_t colour, From start, size_t p) {
    if (last_axis == 1) return relax_row(l, colour, start, b, x, p, 0);
    for (size_t j = 0; j < l.n[1]; ++j) relax_row(l, colour, start, b, x, j, p);
  };
  const size_t second = 1 - first;
  const bool wraps = grid_.periodic[0] || grid_.periodic[1] || grid_.periodic[2];
  // Along a periodic axis of an odd number of cells both ends are of one colour and read each other.
  if (wraps && from == From::zero) zero(l.size(), x, arena), from = From::values;
  if (from == From::values) wrap(l, x, arena);
  arena.for_blocks(layers, block, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      layer(first, from, p);
      if (!wraps && p > begin + 1) layer(second, From::values, p - 1);
    }
  });
  wrap(l, x, arena);
  arena.for_blocks(layers, block, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      if (wraps || p == begin || p + 1 == end) layer(second, From::values, p);
    }
  });
}

void CutPoisson::residual(const Level& l, const double* b, double* x, double* r,
                          const ThreadArena& arena) const {
  wrap(l, x, arena);
  rows(l, arena, [&](size_t at, size_t, size_t) {
    const size_t n = l.n[0];
    if (b) {
      std::copy_n(b + at, n, r + at);
    } else {
      std::fill_n(r + at, n, 0.0);
    }
    const double sign = b ? 1 : -1;
    for (size_t a = 0; a < grid_.dimensions; ++a) {
      const size_t s = l.stride(a);
      const double *k = l.k[a].data() + at, *y = x + at;
      const double *k_low = k - s, *high = y + s, *low = y - s;
      double* to = r + at;
#pragma GCC ivdep
      for (size_t i = 0; i < n; ++i) to[i] += sign * (k[i] * (high[i] - y[i]) + k_low[i] * (low[i] - y[i]));
    }
    if (surface_) {
      for (size_t i = at; i < at + n; ++i) r[i] = l.held[i] ? 0 : r[i];
    }
  });
}

void CutPoisson::restrict_to(const Level& fine, Level& coarse, const ThreadArena& arena) const {
  rows(coarse, arena, kFineRows, [&](size_t at, size_t j, size_t q) {
    double* to = coarse.b.data() + at;
    std::fill_n(to, coarse.n[0], 0.0);
    for (const auto& [fq, wq] : fine.to_coarser[2].down[q]) {
      for (const auto& [fj, wj] : fine.to_coarser[1].down[j]) {
        const double* r = fine.r.data() + fine.at(0, fj, fq);
        const double w = wj * wq;
        for (size_t i = 0; i < coarse.n[0]; ++i) {
          double sum = 0;
          for (const auto& [fi, wi] : fine.to_coarser[0].down[i]) sum += wi * r[fi];
          to[i] += w * sum;
        }
      }
    }
    for (size_t i = 0; i < coarse.n[0]; ++i) {
      if (coarse.inverse[at + i] == 0) to[i] = 0;
    }
  });
}

void CutPoisson::correct(const Level& fine, const Level& coarse, double* x, const ThreadArena& arena) const {
  rows(fine, arena, [&](size_t at, size_t j, size_t q) {
    const Between &bj = fine.to_coarser[1].up[j], &bq = fine.to_coarser[2].up[q];
    const double* row[4] = {&coarse.x[coarse.at(0, bj.low, bq.low)], &coarse.x[coarse.at(0, bj.high, bq.low)],
                            &coarse.x[coarse.at(0, bj.low, bq.high)],
                            &coarse.x[coarse.at(0, bj.high, bq.high)]};
    const double w[4] = {(1 - bj.part) * (1 - bq.part), bj.part * (1 - bq.part), (1 - bj.part) * bq.part,
                         bj.part * bq.part};
    const size_t used = bq.part > 0 ? 4 : 2;
    for (size_t i = 0; i < fine.n[0]; ++i) {
      if (fine.inverse[at + i] == 0) continue;
      const Between& bi = fine.to_coarser[0].up[i];
      double sum = 0;
      for (size_t m = 0; m < used; ++m)
        sum += w[m] * ((1 - bi.part) * row[m][bi.low] + bi.part * row[m][bi.high]);
      x[at + i] += sum;
    }
  });
}

void CutPoisson::cycle(size_t level, const double* b, double* x, const ThreadArena& arena) {
  Level& l = levels_[level];
  const bool last = level + 1 == levels_.size();
  const int sweeps = last ? 16 : 2;
  for (int s = 0; s < sweeps; ++s) relax(l, 0, s == 0 ? From::zero : From::values, b, x, arena);
  if (!last) {
    residual(l, b, x, l.r.data(), arena);
    Level& coarse = levels_[level + 1];
    restrict_to(l, coarse, arena);
    cycle(level + 1, coarse.b.data(), coarse.x.data(), arena);
    correct(l, coarse, x, arena);
  }
  for (int s = 0; s < sweeps; ++s) relax(l, 1, From::values, b, x, arena);
}

double CutPoisson::sum(const Vector& of, const ThreadArena& arena) {
  return total(of.size(), arena, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += of[i];
    return sum;
  });
}

double CutPoisson::product(const double* a, const double* b, const ThreadArena& arena) {
  return total(levels_[0].size(), arena, [&](size_t begin, size_t end) {
    double sum[4] = {};
    size_t i = begin;
    for (; i + 4 <= end; i += 4) {
      for (size_t m = 0; m < 4; ++m) sum[m] += a[i + m] * b[i + m];
    }
    for (; i < end; ++i) sum[0] += a[i] * b[i];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
  });
}

CutPoisson::Outcome CutPoisson::solve(double* x, double tolerance, const ThreadArena& arena) {
  const Level& l = levels_[0];
  const double volume = grid_.cell_volume();
  rows(l, arena, [&](size_t at, size_t j, size_t q) {
    const double* from = x + grid_.at(0, j, q);
    for (size_t i = 0; i < l.n[0]; ++i) b_[at + i] = l.inverse[at + i] > 0 ? -volume * from[i] : 0;
  });
  if (singular_ && fluid_cells_ > 0) {
    const double mean = sum(b_, arena) / fluid_cells_;
    rows(l, arena, [&](size_t at, size_t, size_t) {
      for (size_t i = at; i < at + l.n[0]; ++i) b_[i] -= l.inverse[i] > 0 ? mean : 0;
    });
  }
  Vector& solution = levels_[0].b;
  zero(solution.size(), solution.data(), arena);
  arena.for_blocks(b_.size(), kBlockRows, [&](size_t begin, size_t end) {
    std::copy_n(b_.data() + begin, end - begin, r_.data() + begin);
  });
  // r_ and q_ are zero beyond the sides, so that the products ignore what `wrap` writes there.
  const double first = std::sqrt(product(r_.data(), r_.data(), arena));
  Outcome out;
  out.residual = first > 0 ? 1 : 0;
  double rz_before = 0;
  while (out.residual > tolerance && out.iterations < kMostIterations) {
    cycle(0, r_.data(), z_.data(), arena);
    const double rz = product(r_.data(), z_.data(), arena);
    if (!(rz > 0)) break;
    const double beta = rz_before > 0 ? rz / rz_before : 0;
    rows(l, arena, [&](size_t at, size_t, size_t) {
      for (size_t i = at; i < at + l.n[0]; ++i) p_[i] = z_[i] + beta * p_[i];
    });
    residual(l, nullptr, p_.data(), q_.data(), arena);
    const double curvature = product(p_.data(), q_.data(), arena);
    if (!(curvature > 0)) break;
    const double step = rz / curvature;
    rows(l, arena, [&](size_t at, size_t, size_t) {
      for (size_t i = at; i < at + l.n[0]; ++i) solution[i] += step * p_[i], r_[i] -= step * q_[i];
    });
    rz_before = rz, ++out.iterations;
    out.residual = std::sqrt(product(r_.data(), r_.data(), arena)) / first;
  }
  rows(l, arena, [&](size_t at, size_t j, size_t q) {
    std::copy_n(solution.data() + at, l.n[0], x + grid_.at(0, j, q));
  });
  return out;
}

}  // namespace truestep::lattice
