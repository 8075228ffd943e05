#include "engine/math/solvers/two_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/errors.h"

namespace truestep {

namespace {

constexpr size_t kTaskRows = 1024;          // per task
constexpr size_t kWanted = 400;             // number of aggregates: a factorisation of this size costs little
constexpr size_t kLeast = 24, kMost = 512;  // rows per aggregate
constexpr int kPowerSteps = 10;
constexpr double kAbove = 1.15, kLowest = 0.12;  // part of the spectrum that the polynomials smooth
constexpr int kDegree = 3;

template <class Body>
void blocks(const ThreadArena& arena, size_t n, Body body) {
  arena.for_blocks(n, kTaskRows, [&](size_t begin, size_t end) { body(begin / kTaskRows, begin, end); });
}

Vec3 times(const double* block, const Vec3& v) {
  return {block[0] * v.x + block[3] * v.y + block[6] * v.z, block[1] * v.x + block[4] * v.y + block[7] * v.z,
          block[2] * v.x + block[5] * v.y + block[8] * v.z};
}

double dot_rows(const double* a, const double* b, size_t begin, size_t end) {
  double s = 0;
  for (size_t i = 3 * begin; i < 3 * end; ++i) s += a[i] * b[i];
  return s;
}

double total(std::span<const double> sums) {
  double t = 0;
  for (const double s : sums) t += s;
  return t;
}

// Columns of P: unit translations, then unit rotations about the aggregate's centre.
using Columns = std::array<Vec3, 6>;
Columns columns_of(const double* arm, const double* free) {
  const Vec3 r = load3(arm, 0);
  Columns out{Vec3{1, 0, 0},      Vec3{0, 1, 0},      Vec3{0, 0, 1},
              Vec3{0, -r.z, r.y}, Vec3{r.z, 0, -r.x}, Vec3{-r.y, r.x, 0}};
  for (Vec3& c : out) c = {c.x * free[0], c.y * free[1], c.z * free[2]};
  return out;
}

}  // namespace

void TwoGrid::analyze(const BlockSparse& a) {
  if (a.pattern_stamp() == stamp_) return;
  if (a.block_size() != 3) throw Error("bad_pattern", "two grids need blocks of 3 rows");
  constexpr uint32_t kNone = 0xffffffff;
  const size_t n = a.block_rows(), most = std::clamp(n / kWanted, kLeast, kMost);
  aggregate_.assign(n, kNone);
  std::vector<uint32_t> sizes, ring;
  for (uint32_t seed = 0; seed < n; ++seed) {
    if (aggregate_[seed] != kNone) continue;
    // Breadth first, ring by ring, so that aggregates are round.
    const auto own = static_cast<uint32_t>(sizes.size());
    ring.assign(1, seed);
    aggregate_[seed] = own;
    for (size_t k = 0; k < ring.size() && ring.size() < most; ++k) {
      for (auto s = a.row_begin(ring[k]); s < a.row_begin(ring[k] + 1) && ring.size() < most; ++s) {
        const uint32_t next = a.column(s);
        if (aggregate_[next] != kNone) continue;
        aggregate_[next] = own;
        ring.push_back(next);
      }
    }
    // Remainders between other aggregates join the smallest neighbour.
    uint32_t host = own;
    if (ring.size() < most / 4) {
      for (const uint32_t i : ring) {
        for (auto s = a.row_begin(i); s < a.row_begin(i + 1); ++s) {
          const uint32_t other = aggregate_[a.column(s)];
          if (other != own && (host == own || sizes[other] < sizes[host])) host = other;
        }
      }
    }
    if (host == own) {
      sizes.push_back(static_cast<uint32_t>(ring.size()));
    } else {
      for (const uint32_t i : ring) aggregate_[i] = host;
      sizes[host] += static_cast<uint32_t>(ring.size());
    }
  }
  begin_.assign(sizes.size() + 1, 0);
  for (size_t k = 0; k < sizes.size(); ++k) begin_[k + 1] = begin_[k] + sizes[k];
  rows_.resize(n);
  std::vector<uint32_t> at(begin_.begin(), begin_.end() - 1);
  for (uint32_t i = 0; i < n; ++i) rows_[at[aggregate_[i]]++] = i;

  std::vector<BlockSparse::Pair> pairs;
  for (uint32_t i = 0; i < n; ++i) {
    for (auto s = a.row_begin(i); s < a.row_begin(i + 1); ++s) {
      const uint32_t k = aggregate_[i], l = aggregate_[a.column(s)];
      if (k <= l) pairs.push_back({k, l});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<BlockSparse::Pair> both;
  for (const auto& [k, l] : pairs) {
    for (const uint32_t r : {2 * k, 2 * k + 1}) {
      for (const uint32_t c : {2 * l, 2 * l + 1}) both.push_back({r, c});
    }
  }
  coarse_.set_pattern(2 * sizes.size(), 3, both);
  coarse_solver_.analyze(coarse_);
  slot_.resize(a.blocks());
  for (uint32_t i = 0; i < n; ++i) {
    for (auto s = a.row_begin(i); s < a.row_begin(i + 1); ++s)
      slot_[s] = coarse_.slot(2 * size_t{aggregate_[i]}, 2 * size_t{aggregate_[a.column(s)]});
  }
  for (Vector* v : {&arm_, &free_, &r_, &z_, &p_, &q_, &d_, &s_, &t_}) v->resize(3 * n + 3);
  inverse_.resize(9 * n + 3);
  sums_.resize((n + kTaskRows - 1) / kTaskRows);
  small_.resize(6 * sizes.size());
  stamp_ = a.pattern_stamp();
}

bool TwoGrid::prepare(const BlockSparse& a, std::span<const double> places, const ThreadArena& arena) {
  analyze(a);
  const size_t n = a.block_rows();
  blocks(arena, n, [&](size_t, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      invert_block3(a.block(a.diagonal_slot(i)).data(), inverse_.data() + 9 * i);
      // Components coupled to nothing stay out of the coarse grid.
      double coupled[3] = {};
      for (auto s = a.row_begin(i); s < a.row_begin(i + 1); ++s) {
        if (a.column(s) == i) continue;
        const double* m = a.block(s).data();
        for (size_t k = 0; k < 9; ++k) coupled[k % 3] += std::abs(m[k]);
      }
      for (size_t c = 0; c < 3; ++c) free_[3 * i + c] = coupled[c] > 0 ? 1 : 0;
    }
  });
  // Aggregates write rows of their own; first their arms, which neighbours read.
  arena.for_blocks(aggregates(), 8, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      Vec3 centre;
      for (uint32_t m = begin_[k]; m < begin_[k + 1]; ++m) centre += load3(places.data(), rows_[m]);
      centre = centre / static_cast<double>(begin_[k + 1] - begin_[k]);
      for (uint32_t m = begin_[k]; m < begin_[k + 1]; ++m)
        store3(arm_.data(), rows_[m], load3(places.data(), rows_[m]) - centre);
    }
  });
  coarse_.set_zero();
  arena.for_blocks(aggregates(), 8, [&](size_t begin, size_t end) {
    for (uint32_t m = begin_[begin]; m < begin_[end]; ++m) {
      const uint32_t i = rows_[m];
      const size_t k = aggregate_[i];
      const Columns left = columns_of(&arm_[3 * i], &free_[3 * i]);
      for (auto s = a.row_begin(i); s < a.row_begin(i + 1); ++s) {
        const uint32_t j = a.column(s);
        const Columns right = columns_of(&arm_[3 * j], &free_[3 * j]);
        double block[4][9];
        for (size_t c = 0; c < 6; ++c) {
          const Vec3 v = times(a.block(s).data(), right[c]);
          for (size_t r = 0; r < 6; ++r) block[2 * (r / 3) + c / 3][3 * (c % 3) + r % 3] = dot(left[r], v);
        }
        // Rows of translation and of rotation have the same columns, one after another.
        const BlockSparse::Slot first = slot_[s];
        const BlockSparse::Slot below = first - coarse_.row_begin(2 * k) + coarse_.row_begin(2 * k + 1);
        coarse_.add_block(first, block[0]);
        coarse_.add_block(first + 1, block[1]);
        coarse_.add_block(below, block[2]);
        coarse_.add_block(below + 1, block[3]);
      }
    }
  });
  // Motions that an aggregate does not have, like rotations of a single row or of held rows.
  constexpr double kNothing = 1e-12;
  for (size_t k = 0; k < 2 * aggregates(); ++k) {
    const auto diagonal = coarse_.block(coarse_.diagonal_slot(k));
    const double size = diagonal[0] + diagonal[4] + diagonal[8];
    for (size_t c = 0; c < 3; ++c) {
      if (!(diagonal[4 * c] > kNothing * size)) diagonal[4 * c] += size > 0 ? size : 1;
    }
  }
  if (coarse_solver_.factorize(coarse_) != BlockLdlt::Outcome::positive_definite) return false;
  highest_ = kAbove * largest_eigenvalue(a, arena);
  return highest_ > 0 && std::isfinite(highest_);
}

// Of D^-1 A, by power iteration from a vector of pseudo-random signs, which contains every mode.
double TwoGrid::largest_eigenvalue(const BlockSparse& a, const ThreadArena& arena) {
  const size_t n = a.block_rows();
  for (size_t i = 0; i < 3 * n; ++i) p_[i] = (i * 2654435761u >> 7) % 2 ? 1 : -1;
  double value = 1;
  for (int step = 0; step < kPowerSteps; ++step) {
    blocks(arena, n, [&](size_t block, size_t begin, size_t end) {
      a.multiply_rows(p_.data(), q_.data(), begin, end);
      for (size_t i = begin; i < end; ++i) {
        store3(q_.data(), i, times(inverse_.data() + 9 * i, load3(q_.data(), i)));
      }
      sums_[block] = dot_rows(q_.data(), q_.data(), begin, end);
    });
    value = std::sqrt(total(sums_));
    if (!(value > 0)) return 0;
    for (size_t i = 0; i < 3 * n; ++i) p_[i] = q_[i] / value;
  }
  return value;
}

// z = polynomial(D^-1 A) D^-1 r by Chebyshev's iteration (Saad 2003, algorithm 12.1); z may be r.
void TwoGrid::smooth(const BlockSparse& a, const double* r, double* z, const ThreadArena& arena) {
  const size_t n = a.block_rows();
  const double low = kLowest * highest_, theta = 0.5 * (highest_ + low), delta = 0.5 * (highest_ - low),
               sigma = theta / delta;
  double rho = 1 / sigma;
  blocks(arena, n, [&](size_t, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 given = load3(r, i);  // z may be r
      const Vec3 d = times(inverse_.data() + 9 * i, given) / theta;
      store3(d_.data(), i, d), store3(z, i, d), store3(s_.data(), i, given);
    }
  });
  for (int k = 1; k < kDegree; ++k) {
    const double next = 1 / (2 * sigma - rho);
    blocks(arena, n, [&](size_t, size_t begin, size_t end) {
      a.multiply_rows(d_.data(), t_.data(), begin, end);
      for (size_t i = 3 * begin; i < 3 * end; ++i) s_[i] -= t_[i];
    });
    blocks(arena, n, [&](size_t, size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const Vec3 d = (next * rho) * load3(d_.data(), i) +
                       (2 * next / delta) * times(inverse_.data() + 9 * i, load3(s_.data(), i));
        store3(d_.data(), i, d), store3(z, i, load3(z, i) + d);
      }
    });
    rho = next;
  }
}

// z += P A_c^-1 P^T r
void TwoGrid::correct(const double* r, double* z, const ThreadArena& arena) {
  arena.for_blocks(aggregates(), 8, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      double sum[6] = {};
      for (uint32_t m = begin_[k]; m < begin_[k + 1]; ++m) {
        const uint32_t i = rows_[m];
        const Columns p = columns_of(&arm_[3 * i], &free_[3 * i]);
        for (size_t c = 0; c < 6; ++c) sum[c] += dot(p[c], load3(r, i));
      }
      std::copy_n(sum, 6, &small_[6 * k]);
    }
  });
  coarse_solver_.solve(small_, small_);
  arena.for_blocks(aggregates(), 8, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      for (uint32_t m = begin_[k]; m < begin_[k + 1]; ++m) {
        const uint32_t i = rows_[m];
        const Columns p = columns_of(&arm_[3 * i], &free_[3 * i]);
        Vec3 v = load3(z, i);
        for (size_t c = 0; c < 6; ++c) v += small_[6 * k + c] * p[c];
        store3(z, i, v);
      }
    }
  });
}

// Smoothed, corrected, smoothed: symmetric, as conjugate gradients need.
void TwoGrid::precondition(const BlockSparse& a, const double* r, double* z, const ThreadArena& arena) {
  const size_t n = a.block_rows();
  const auto left_over = [&] {
    blocks(arena, n, [&](size_t, size_t begin, size_t end) {
      a.multiply_rows(z, q_.data(), begin, end);
      for (size_t i = 3 * begin; i < 3 * end; ++i) q_[i] = r[i] - q_[i];
    });
  };
  smooth(a, r, z, arena);
  left_over();
  correct(q_.data(), z, arena);
  left_over();
  smooth(a, q_.data(), q_.data(), arena);
  for (size_t i = 0; i < 3 * n; ++i) z[i] += q_[i];
}

Pcg::Result TwoGrid::solve(const BlockSparse& a, std::span<const double> places, std::span<const double> b,
                           std::span<double> x, double tolerance, int max_iterations,
                           const ThreadArena& arena) {
  if (!prepare(a, places, arena)) return {Pcg::Outcome::negative_curvature, 0, 1};
  return solve_again(a, b, x, tolerance, max_iterations, arena);
}

Pcg::Result TwoGrid::solve_again(const BlockSparse& a, std::span<const double> b, std::span<double> x,
                                 double tolerance, int max_iterations, const ThreadArena& arena) {
  const size_t n = a.block_rows();
  std::copy(b.begin(), b.end(), r_.begin());
  std::fill(x.begin(), x.end(), 0.0);
  const auto products = [&](const Vector& u, const Vector& v) {
    blocks(arena, n, [&](size_t block, size_t begin, size_t end) {
      sums_[block] = dot_rows(u.data(), v.data(), begin, end);
    });
    return total(sums_);
  };
  precondition(a, r_.data(), z_.data(), arena);
  double rz = products(r_, z_);
  const double start = rz;
  if (start == 0) return {Pcg::Outcome::converged, 0, 0};
  if (!(start > 0)) return {Pcg::Outcome::negative_curvature, 0, 1};
  std::copy(z_.begin(), z_.end(), p_.begin());
  for (int it = 1;; ++it) {
    blocks(arena, n, [&](size_t block, size_t begin, size_t end) {
      a.multiply_rows(p_.data(), q_.data(), begin, end);
      sums_[block] = dot_rows(p_.data(), q_.data(), begin, end);
    });
    const double pq = total(sums_);
    if (!(pq > 0)) return {Pcg::Outcome::negative_curvature, it, std::sqrt(rz / start)};
    const double alpha = rz / pq;
    for (size_t i = 0; i < 3 * n; ++i) x[i] += alpha * p_[i], r_[i] -= alpha * q_[i];
    precondition(a, r_.data(), z_.data(), arena);
    const double next = products(r_, z_);
    if (!(next >= 0)) return {Pcg::Outcome::negative_curvature, it, std::sqrt(rz / start)};
    if (next <= tolerance * tolerance * start) return {Pcg::Outcome::converged, it, std::sqrt(next / start)};
    if (it >= max_iterations) return {Pcg::Outcome::out_of_iterations, it, std::sqrt(next / start)};
    const double beta = next / rz;
    rz = next;
    for (size_t i = 0; i < 3 * n; ++i) p_[i] = z_[i] + beta * p_[i];
  }
}

}  // namespace truestep
