#include "engine/math/solvers/block_ldlt.h"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"
#include "engine/math/lanes.h"

namespace truestep {

namespace {

// The block row in progress stores its columns 4 apart, so that whole columns load and store.
template <int B>
constexpr size_t kStride = B == 1 ? 1 : 4;

// y -= u l^T; y and u with padded columns, l packed.
inline void subtract_product(double* y, const Lanes4 u[3], const double* l) {
  for (int c = 0; c < 3; ++c) {
    Lanes4::load(y + 4 * c).minus(u[0], l[c]).minus(u[1], l[3 + c]).minus(u[2], l[6 + c]).store(y + 4 * c);
  }
}

// Inverse of a symmetric 3 x 3 matrix (packed columns) by its own LDL^T; the signs of D tell definiteness.
BlockLdlt::Outcome invert3(const double* a, double* inv) {
  const double d0 = a[0], l10 = a[1] / d0, l20 = a[2] / d0;
  const double d1 = a[4] - l10 * a[1], l21 = (a[5] - l20 * a[1]) / d1;
  const double d2 = a[8] - l20 * a[2] - l21 * (a[5] - l20 * a[1]);
  if (!(d0 * d1 * d2 != 0) || !std::isfinite(1 / d0) || !std::isfinite(1 / d1) || !std::isfinite(1 / d2)) {
    return BlockLdlt::Outcome::singular;
  }
  // Columns of L^-1: (1, -l10, l10 l21 - l20), (0, 1, -l21), (0, 0, 1).
  const double m10 = -l10, m20 = l10 * l21 - l20, m21 = -l21;
  const double e0 = 1 / d0, e1 = 1 / d1, e2 = 1 / d2;
  inv[0] = e0 + m10 * m10 * e1 + m20 * m20 * e2;
  inv[1] = inv[3] = m10 * e1 + m20 * m21 * e2;
  inv[2] = inv[6] = m20 * e2;
  inv[4] = e1 + m21 * m21 * e2;
  inv[5] = inv[7] = m21 * e2;
  inv[8] = e2;
  return d0 > 0 && d1 > 0 && d2 > 0 ? BlockLdlt::Outcome::positive_definite : BlockLdlt::Outcome::indefinite;
}

}  // namespace

void BlockLdlt::analyze(const BlockSparse& a) {
  if (stamp_ == a.pattern_stamp()) return;
  if (a.block_size() != 1 && a.block_size() != 3) {
    throw Error("bad_pattern", "direct factorisation needs blocks of 1 or 3 rows");
  }
  block_size_ = a.block_size();
  n_ = a.block_rows();
  order_.resize(n_), place_.resize(n_);

  // Minimum degree on the graph of blocks.
  Eigen::SparseMatrix<double> graph(static_cast<int>(n_), static_cast<int>(n_));
  std::vector<Eigen::Triplet<double>> edges;
  edges.reserve(a.blocks());
  for (uint32_t i = 0; i < n_; ++i) {
    for (auto s = a.row_begin(i); s < a.row_begin(i + 1); ++s) {
      edges.emplace_back(static_cast<int>(i), static_cast<int>(a.column(s)), 1.0);
    }
  }
  graph.setFromTriplets(edges.begin(), edges.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(graph, permutation);
  for (uint32_t i = 0; i < n_; ++i) {
    order_[i] = static_cast<uint32_t>(permutation.indices()[i]);
    place_[order_[i]] = i;
  }

  // Lower half in the new order, row by row.
  row_begin_.assign(n_ + 1, 0);
  row_column_.clear(), row_slot_.clear();
  for (uint32_t k = 0; k < n_; ++k) {
    const uint32_t old = order_[k];
    for (auto s = a.row_begin(old); s < a.row_begin(old + 1); ++s) {
      if (place_[a.column(s)] <= k) row_column_.push_back(place_[a.column(s)]), row_slot_.push_back(s);
    }
    row_begin_[k + 1] = static_cast<uint32_t>(row_column_.size());
  }

  // Elimination tree and lengths of L's columns.
  parent_.assign(n_, -1);
  mark_.assign(n_, UINT32_MAX);
  std::vector<size_t> length(n_, 0);
  for (uint32_t k = 0; k < n_; ++k) {
    mark_[k] = k;
    for (uint32_t p = row_begin_[k]; p < row_begin_[k + 1]; ++p) {
      for (uint32_t i = row_column_[p]; mark_[i] != k; i = static_cast<uint32_t>(parent_[i])) {
        if (parent_[i] < 0) parent_[i] = static_cast<int32_t>(k);
        ++length[i];
        mark_[i] = k;
      }
    }
  }
  column_begin_.assign(n_ + 1, 0);
  work_ = 0;
  for (size_t i = 0; i < n_; ++i) {
    column_begin_[i + 1] = column_begin_[i] + length[i];
    work_ += 0.5 * double(length[i]) * double(length[i] + 3);
  }
  const auto b = static_cast<size_t>(block_size_), bb = b * b;
  column_row_.resize(column_begin_[n_]);
  lower_.resize(column_begin_[n_] * bb + 3);
  inverse_.resize(n_ * bb + 3);
  row_.assign(n_ * (b == 1 ? 1 : 12) + 4, 0.0);
  rhs_.resize(n_ * b + 1);
  filled_.resize(n_), stack_.resize(n_);
  stamp_ = a.pattern_stamp();
}

template <int B>
BlockLdlt::Outcome BlockLdlt::factorize_blocks(const BlockSparse& a) {
  constexpr size_t kPacked = B * B, kPadded = B * kStride<B>;
  const double* values = a.values().data();
  Outcome outcome = Outcome::positive_definite;
  std::fill(filled_.begin(), filled_.end(), 0u);
  std::fill(mark_.begin(), mark_.end(), UINT32_MAX);
  for (uint32_t k = 0; k < n_; ++k) {
    if (k % 64 == 0) interruption_point();
    // Scatter row k of A and find which columns of L it meets, in an order that respects the tree.
    size_t top = n_;
    mark_[k] = k;
    for (uint32_t p = row_begin_[k]; p < row_begin_[k + 1]; ++p) {
      const double* from = values + size_t{row_slot_[p]} * kPacked;
      double* to = row_.data() + row_column_[p] * kPadded;
      for (int c = 0; c < B; ++c) {
        for (int r = 0; r < B; ++r) to[size_t(c) * kStride<B> + size_t(r)] = from[c * B + r];
      }
      size_t length = 0;
      for (uint32_t i = row_column_[p]; mark_[i] != k; i = static_cast<uint32_t>(parent_[i])) {
        stack_[length++] = i;
        mark_[i] = k;
      }
      while (length > 0) stack_[--top] = stack_[--length];
    }
    // y_i = row k, column i of L D; subtract its contribution from the columns to the right.
    double* diagonal = row_.data() + k * kPadded;
    for (; top < n_; ++top) {
      const uint32_t i = stack_[top];
      double* y = row_.data() + i * kPadded;
      const double* inverse = inverse_.data() + i * kPacked;
      const size_t first = column_begin_[i], next = first + filled_[i];
      double* l = lower_.data() + next * kPacked;
      if constexpr (B == 1) {
        const double u = *y;
        *y = 0;
        for (size_t p = first; p < next; ++p) row_[column_row_[p]] -= u * lower_[p];
        *l = u * *inverse;
        *diagonal -= u * *l;
      } else {
        const Lanes4 u[3] = {Lanes4::load(y), Lanes4::load(y + 4), Lanes4::load(y + 8)};
        for (size_t e = 0; e < 12; ++e) y[e] = 0;
        for (size_t p = first; p < next; ++p) {
          subtract_product(row_.data() + column_row_[p] * kPadded, u, lower_.data() + 9 * p);
        }
        for (int c = 0; c < 3; ++c) {
          const Lanes4 column = Lanes4::zero()
                                    .plus(u[0], inverse[3 * c])
                                    .plus(u[1], inverse[3 * c + 1])
                                    .plus(u[2], inverse[3 * c + 2]);
          truestep::store3(column, l + 3 * c);
        }
        subtract_product(diagonal, u, l);
      }
      column_row_[next] = k;
      ++filled_[i];
    }
    // Invert the diagonal block.
    Outcome here;
    if constexpr (B == 1) {
      const double d = *diagonal;
      *diagonal = 0;
      inverse_[k] = 1 / d;
      here = !std::isfinite(inverse_[k]) || d != d ? Outcome::singular
             : d > 0                               ? Outcome::positive_definite
                                                   : Outcome::indefinite;
    } else {
      double packed[9];
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) packed[3 * c + r] = diagonal[4 * c + r];
      }
      for (size_t e = 0; e < 12; ++e) diagonal[e] = 0;
      here = invert3(packed, inverse_.data() + 9 * size_t{k});
    }
    if (here == Outcome::singular) {
      std::fill(row_.begin(), row_.end(), 0.0);
      return here;
    }
    outcome = std::max(outcome, here);
  }
  return outcome;
}

template <int B>
void BlockLdlt::solve_blocks(std::span<const double> b, std::span<double> x) {
  double* y = rhs_.data();
  for (size_t k = 0; k < n_; ++k) {
    for (int r = 0; r < B; ++r) y[k * B + size_t(r)] = b[order_[k] * size_t{B} + size_t(r)];
  }
  const auto lower = [&](size_t p) { return lower_.data() + p * size_t(B * B); };
  for (size_t i = 0; i < n_; ++i) {
    const double* yi = y + i * B;
    for (size_t p = column_begin_[i]; p < column_begin_[i + 1]; ++p) {
      double* to = y + column_row_[p] * size_t{B};
      for (int r = 0; r < B; ++r) {
        double sum = to[r];
        for (int c = 0; c < B; ++c) sum = std::fma(-lower(p)[c * B + r], yi[c], sum);
        to[r] = sum;
      }
    }
  }
  for (size_t i = n_; i-- > 0;) {
    const double* inverse = inverse_.data() + i * size_t(B * B);
    double sum[B] = {};
    for (int r = 0; r < B; ++r) {
      for (int c = 0; c < B; ++c) sum[r] = std::fma(inverse[c * B + r], y[i * B + size_t(c)], sum[r]);
    }
    for (size_t p = column_begin_[i]; p < column_begin_[i + 1]; ++p) {
      const double* from = y + column_row_[p] * size_t{B};
      for (int c = 0; c < B; ++c) {
        for (int r = 0; r < B; ++r) sum[c] = std::fma(-lower(p)[c * B + r], from[r], sum[c]);
      }
    }
    for (int r = 0; r < B; ++r) y[i * B + size_t(r)] = sum[r];
  }
  for (size_t k = 0; k < n_; ++k) {
    for (int r = 0; r < B; ++r) x[order_[k] * size_t{B} + size_t(r)] = y[k * B + size_t(r)];
  }
}

void BlockLdlt::solve_three(std::span<const double> b, std::span<double> x) {
  if (block_size_ != 1) throw Error("bad_pattern", "three right-hand sides are for blocks of one number");
  if (rhs_.size() < 4 * n_) rhs_.resize(4 * n_);
  double* y = rhs_.data();
  for (size_t k = 0; k < n_; ++k) {
    const double* from = b.data() + 3 * size_t{order_[k]};
    y[4 * k] = from[0], y[4 * k + 1] = from[1], y[4 * k + 2] = from[2], y[4 * k + 3] = 0;
  }
  for (size_t i = 0; i < n_; ++i) {
    const Lanes4 yi = Lanes4::load(y + 4 * i);
    for (size_t p = column_begin_[i]; p < column_begin_[i + 1]; ++p) {
      double* to = y + 4 * size_t{column_row_[p]};
      Lanes4::load(to).minus(yi, lower_[p]).store(to);
    }
  }
  for (size_t i = n_; i-- > 0;) {
    Lanes4 sum = Lanes4::zero().plus(Lanes4::load(y + 4 * i), inverse_[i]);
    for (size_t p = column_begin_[i]; p < column_begin_[i + 1]; ++p) {
      sum = sum.minus(Lanes4::load(y + 4 * size_t{column_row_[p]}), lower_[p]);
    }
    sum.store(y + 4 * i);
  }
  for (size_t k = 0; k < n_; ++k) {
    double* to = x.data() + 3 * size_t{order_[k]};
    to[0] = y[4 * k], to[1] = y[4 * k + 1], to[2] = y[4 * k + 2];
  }
}

BlockLdlt::Outcome BlockLdlt::factorize(const BlockSparse& a) {
  analyze(a);
  return block_size_ == 1 ? factorize_blocks<1>(a) : factorize_blocks<3>(a);
}

void BlockLdlt::solve(std::span<const double> b, std::span<double> x) {
  if (block_size_ == 1) {
    solve_blocks<1>(b, x);
  } else {
    solve_blocks<3>(b, x);
  }
}

}  // namespace truestep
