#include "engine/math/solvers/pcg.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/math/lanes.h"

namespace truestep {

namespace {

// Rows per task: few enough that a cloth keeps several threads busy.
constexpr size_t kSummedRows = 1024;

template <class Body>
void rows(const ThreadArena& arena, size_t n, Body body) {
  arena.for_blocks(n, kSummedRows, [&](size_t begin, size_t end) { body(begin / kSummedRows, begin, end); });
}

// z = D^-1 r for block rows [begin, end).
template <int B>
void precondition(const double* inverse, const double* r, double* z, size_t begin, size_t end) {
  for (size_t i = begin; i < end; ++i) {
    if constexpr (B == 1) {
      z[i] = inverse[i] * r[i];
    } else {
      const double* m = inverse + 9 * i;
      const double* v = r + 3 * i;
      store3(Lanes4::zero()
                 .plus(Lanes4::load(m), v[0])
                 .plus(Lanes4::load(m + 3), v[1])
                 .plus(Lanes4::load(m + 6), v[2]),
             z + 3 * i);
    }
  }
}

double dot_range(const double* a, const double* b, size_t begin, size_t end) {
  double s[4] = {};
  size_t i = begin;
  for (; i + 4 <= end; i += 4) {
    for (size_t k = 0; k < 4; ++k) s[k] += a[i + k] * b[i + k];
  }
  for (; i < end; ++i) s[0] += a[i] * b[i];
  return (s[0] + s[1]) + (s[2] + s[3]);
}

double total(const std::vector<double, CacheLineAllocator<double>>& sums) {
  double t = 0;
  for (const double s : sums) t += s;
  return t;
}

}  // namespace

void invert_block3(const double* a, double* inverse) {
  const double c0 = a[4] * a[8] - a[5] * a[7], c1 = a[7] * a[2] - a[1] * a[8], c2 = a[1] * a[5] - a[4] * a[2];
  const double det = a[0] * c0 + a[3] * c1 + a[6] * c2;
  const double f = det != 0 && std::isfinite(1 / det) ? 1 / det : 0;
  inverse[0] = f * c0, inverse[1] = f * c1, inverse[2] = f * c2;
  inverse[3] = f * (a[5] * a[6] - a[3] * a[8]);
  inverse[4] = f * (a[0] * a[8] - a[2] * a[6]);
  inverse[5] = f * (a[2] * a[3] - a[0] * a[5]);
  inverse[6] = f * (a[3] * a[7] - a[4] * a[6]);
  inverse[7] = f * (a[1] * a[6] - a[0] * a[7]);
  inverse[8] = f * (a[0] * a[4] - a[1] * a[3]);
}

void Pcg::reserve(const BlockSparse& a) {
  const size_t n = a.block_rows();
  const auto width = static_cast<size_t>(a.block_size());
  for (Vector* v : {&r_, &z_, &p_, &q_}) v->resize(a.size() + 1);
  inverse_.resize(n * width * width + 3);
  sums_.resize((n + kSummedRows - 1) / kSummedRows);
}

Pcg::Result Pcg::solve(const BlockSparse& a, std::span<const double> b, std::span<double> x, double tolerance,
                       int max_iterations, const ThreadArena& arena) {
  const size_t n = a.block_rows(), size = a.size();
  const auto width = static_cast<size_t>(a.block_size());
  if (width != 1 && width != 3) throw Error("bad_pattern", "conjugate gradients need blocks of 1 or 3 rows");
  reserve(a);
  double *r = r_.data(), *z = z_.data(), *p = p_.data(), *q = q_.data();

  const auto apply = [&](size_t begin, size_t end) {
    if (width == 1) {
      precondition<1>(inverse_.data(), r, z, begin, end);
    } else {
      precondition<3>(inverse_.data(), r, z, begin, end);
    }
  };
  rows(arena, n, [&](size_t block, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double* d = a.block(a.diagonal_slot(i)).data();
      if (width == 1) {
        inverse_[i] = *d != 0 ? 1 / *d : 0;
      } else {
        invert_block3(d, inverse_.data() + 9 * i);
      }
    }
    std::copy(b.begin() + long(begin * width), b.begin() + long(end * width), r + begin * width);
    std::fill(x.begin() + long(begin * width), x.begin() + long(end * width), 0.0);
    apply(begin, end);
    std::copy(z + begin * width, z + end * width, p + begin * width);
    sums_[block] = dot_range(r, z, begin * width, end * width);
  });
  double rz = total(sums_);
  const double start = rz;
  if (start == 0) return {Outcome::converged, 0, 0};
  if (!(start > 0)) return {Outcome::negative_curvature, 0, 1};

  for (int it = 1;; ++it) {
    rows(arena, n, [&](size_t block, size_t begin, size_t end) {
      a.multiply_rows(p, q, begin, end);
      sums_[block] = dot_range(p, q, begin * width, end * width);
    });
    const double pq = total(sums_);
    if (!(pq > 0)) return {Outcome::negative_curvature, it, std::sqrt(rz / start)};
    const double alpha = rz / pq;
    rows(arena, n, [&](size_t block, size_t begin, size_t end) {
      for (size_t i = begin * width; i < end * width; ++i) {
        x[i] += alpha * p[i];
        r[i] -= alpha * q[i];
      }
      apply(begin, end);
      sums_[block] = dot_range(r, z, begin * width, end * width);
    });
    const double next = total(sums_);
    if (!(next >= 0)) return {Outcome::negative_curvature, it, std::sqrt(rz / start)};
    if (next <= tolerance * tolerance * start) return {Outcome::converged, it, std::sqrt(next / start)};
    if (it >= max_iterations) return {Outcome::out_of_iterations, it, std::sqrt(next / start)};
    const double beta = next / rz;
    rz = next;
    arena.for_blocks(size, kSummedRows * width, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) p[i] = z[i] + beta * p[i];
    });
  }
}

}  // namespace truestep
