#include "engine/integrators/implicit/newton/newton_matrix.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <type_traits>

#include "engine/base/errors.h"
#include "engine/core/equations/linear_solver.h"
#include "engine/integrators/linear/sparse_factors.h"
#include "engine/math/solvers/reordering.h"

namespace truestep {

namespace {

// Up to this size a dense factorisation is at least as fast as any that uses a pattern.
constexpr size_t kAlwaysDense = 24;
constexpr size_t kDenseIfNoBand = 128;
constexpr size_t kLargestDense = 4000;  // 128 MB
// Multiplications up to which the simple loops of a band beat a sparse factorisation with its bookkeeping.
constexpr double kMostBandWork = 3e8;

bool same(const MatrixShape& a, const MatrixShape& b) {
  return a.kind == b.kind && a.lower == b.lower && a.upper == b.upper &&
         std::ranges::equal(a.column_start, b.column_start) && std::ranges::equal(a.rows, b.rows);
}

}  // namespace

NewtonMatrix::NewtonMatrix() = default;
NewtonMatrix::~NewtonMatrix() = default;

void NewtonMatrix::bind(const RightHandSide& f) {
  own_ = f.linear_solver();
  if (own_) {
    f_ = &f, second_order_ = nullptr, m_ = f.size(), kind_ = Kind::own;
    return;
  }
  if (kind_ == Kind::own) f_ = nullptr;
  const SecondOrder* second = f.second_order();
  const MatrixShape shape = second ? second->shape() : f.jacobian_shape();
  const size_t m = second ? f.size() / 2 : f.size();
  const bool known =
      f_ && m == m_ && (second != nullptr) == (second_order_ != nullptr) && same(shape, shape_);
  f_ = &f, second_order_ = second, m_ = m;
  if (!known) analyse(shape);
}

void NewtonMatrix::analyse(const MatrixShape& shape) {
  if (shape.kind == MatrixShape::Kind::dense && m_ > kLargestDense) {
    throw Error("too_many_unknowns", "implicit methods need the pattern of the derivatives for more than " +
                                         std::to_string(kLargestDense) + " unknowns");
  }
  shape_ = shape;
  column_start_.assign(shape.column_start.begin(), shape.column_start.end());
  rows_.assign(shape.rows.begin(), shape.rows.end());
  shape_.column_start = column_start_, shape_.rows = rows_;
  first_.assign(shape_.values(m_), 0);
  second_.assign(second_order_ ? first_.size() : 0, 0);
  for (auto* v : {&moved_, &rate_, &product_}) v->assign(m_, 0);
  order_.clear(), place_.clear();
  sparse_.reset();
  real_ = {}, complex_ = {};

  const auto band_is_narrow = [&] {
    return 2 * lower_ + upper_ <= m_ / 2 &&
           double(m_) * double(lower_) * double(lower_ + upper_) <= kMostBandWork;
  };
  kind_ = Kind::dense;
  group_.resize(m_);
  if (shape_.kind == MatrixShape::Kind::dense) {
    std::iota(group_.begin(), group_.end(), 0);
    groups_ = int32_t(m_);
  } else if (shape_.kind == MatrixShape::Kind::banded) {
    lower_ = shape_.lower, upper_ = shape_.upper;
    groups_ = int32_t(std::min(m_, lower_ + upper_ + 1));
    for (size_t j = 0; j < m_; ++j) group_[j] = int32_t(j % size_t(groups_));
    if (m_ > kAlwaysDense && 2 * lower_ + upper_ < m_) kind_ = Kind::band;
  } else {
    const ColumnPattern pattern{column_start_, rows_};
    ColumnGroups g = group_columns(pattern);
    group_ = std::move(g.group), groups_ = g.groups;
    if (m_ <= kAlwaysDense) return;
    order_ = reverse_cuthill_mckee(pattern);
    const Bandwidth b = bandwidth(pattern, order_);
    lower_ = b.lower, upper_ = b.upper;
    if (band_is_narrow()) {
      kind_ = Kind::band;
      place_.resize(m_);
      for (size_t k = 0; k < m_; ++k) place_[size_t(order_[k])] = int32_t(k);
    } else {
      order_.clear();
      if (m_ > kDenseIfNoBand) {
        kind_ = Kind::sparse;
        sparse_ = std::make_unique<SparseFactors>(m_, column_start_, rows_);
      }
    }
  }
}

// f(i, k) for every entry (i, j) of column j, k being its index among the values.
template <class F>
void NewtonMatrix::for_column(size_t j, F&& f) const {
  switch (shape_.kind) {
    case MatrixShape::Kind::dense:
      for (size_t i = 0; i < m_; ++i) f(i, j * m_ + i);
      break;
    case MatrixShape::Kind::banded: {
      const size_t width = shape_.lower + shape_.upper + 1;
      const size_t end = std::min(m_, j + shape_.lower + 1);
      for (size_t i = j > shape_.upper ? j - shape_.upper : 0; i < end; ++i) {
        f(i, j * width + shape_.upper + i - j);
      }
      break;
    }
    case MatrixShape::Kind::sparse:
      for (int32_t k = column_start_[j]; k < column_start_[j + 1]; ++k)
        f(size_t(rows_[size_t(k)]), size_t(k));
      break;
  }
}

// values = d evaluate(at) / d at; `evaluate` reads moved_ and writes rate_.
template <class Evaluate>
void NewtonMatrix::differences(const double* at, const double* f_at, double typical, double* values,
                               Evaluate&& evaluate) {
  constexpr double kRootOfRounding = 0x1p-26;
  const auto moved = [&](size_t j) { return at[j] + kRootOfRounding * std::max(std::abs(at[j]), typical); };
  std::copy_n(at, m_, moved_.begin());
  for (int32_t g = 0; g < groups_; ++g) {
    for (size_t j = 0; j < m_; ++j) moved_[j] = group_[j] == g ? moved(j) : at[j];
    evaluate();
    for (size_t j = 0; j < m_; ++j) {
      if (group_[j] != g) continue;
      const double inverse = 1 / (moved_[j] - at[j]);
      for_column(j, [&](size_t i, size_t k) { values[k] = (rate_[i] - f_at[i]) * inverse; });
    }
  }
}

void NewtonMatrix::differentiate(double t, const double* y, const double* fy, double typical,
                                 Statistics& count) {
  ++count.jacobians;
  if (own_) return f_->linearise(t, y);
  if (second_order_) {
    const double *x = y, *v = y + m_;
    if (second_order_->has_jacobian()) {
      second_order_->jacobian(t, x, v, first_.data(), second_.data());
      return;
    }
    differences(x, fy + m_, typical, first_.data(),
                [&] { second_order_->acceleration(t, moved_.data(), v, rate_.data()); });
    count.rates += uint64_t(groups_);
    if (!second_order_->depends_on_velocity()) return;
    differences(v, fy + m_, typical, second_.data(),
                [&] { second_order_->acceleration(t, x, moved_.data(), rate_.data()); });
    count.rates += uint64_t(groups_);
  } else if (f_->has_jacobian()) {
    f_->jacobian(t, y, first_.data());
  } else {
    differences(y, fy, typical, first_.data(), [&] { f_->rate(t, moved_.data(), rate_.data()); });
    count.rates += uint64_t(groups_);
  }
}

FactorWork NewtonMatrix::factor_work() const {
  const auto m = static_cast<double>(m_), l = static_cast<double>(lower_), u = static_cast<double>(upper_);
  switch (kind_) {
    case Kind::dense:
      return {m * m * m / 3, m * m};
    case Kind::band:
      return {m * l * (l + u), m * (2 * l + u)};
    case Kind::own:
      // About a thousand per link, whose unknowns are its joint's coordinates and velocities.
      return {1000 * m, 150 * m};
    case Kind::sparse:
      break;
  }
  return symbolic_factor_work({column_start_, rows_});
}

double NewtonMatrix::jacobian_work(double rate) const {
  if (own_) return 2 * rate;
  const bool own = second_order_ ? second_order_->has_jacobian() : f_->has_jacobian();
  // Derivatives of an entry cost about as much as the rate does per entry of the pattern.
  return own ? 2 * rate + static_cast<double>(first_.size() + second_.size())
             : static_cast<double>(groups_) * (rate + static_cast<double>(m_));
}

template <class T>
bool NewtonMatrix::assemble_and_factor(Factors<T>& f, T with_first, T with_second) {
  const double* a = first_.data();
  const double* b = second_.empty() ? nullptr : second_.data();
  const auto entry = [&](size_t k) {
    return b ? T(0) - (a[k] * with_first + b[k] * with_second) : T(0) - a[k] * with_first;
  };
  if (kind_ == Kind::sparse) {
    if (!f.sized) f.permuted.resize(m_), f.sized = true;
    if constexpr (std::is_same_v<T, double>) {
      const auto masses = second_order_ ? second_order_->symmetric_in() : std::span<const double>{};
      return sparse_->factor(a, b, with_first, with_second, masses);
    } else {
      return sparse_->factor(a, b, with_first, with_second);
    }
  }
  if (kind_ == Kind::dense) {
    if (!f.sized) f.dense.resize(m_), f.permuted.resize(m_), f.sized = true;
    T* m = f.dense.matrix();
    if (shape_.kind == MatrixShape::Kind::dense) {
      for (size_t k = 0; k < m_ * m_; ++k) m[k] = entry(k);
    } else {
      std::fill_n(m, m_ * m_, T(0));
      for (size_t j = 0; j < m_; ++j) {
        for_column(j, [&](size_t i, size_t k) { m[j * m_ + i] = entry(k); });
      }
    }
    for (size_t j = 0; j < m_; ++j) m[j * m_ + j] += T(1);
    return f.dense.factor();
  }
  if (!f.sized) f.band.resize(m_, lower_, upper_), f.permuted.resize(m_), f.sized = true;
  if (place_.empty()) {
    const size_t width = lower_ + upper_ + 1;
    for (size_t j = 0; j < m_; ++j) {
      T* c = f.band.column(j);
      for (size_t i = 0; i < width; ++i) c[i] = entry(j * width + i);
      c[upper_] += T(1);
    }
  } else {
    for (size_t j = 0; j < m_; ++j) {
      const size_t to = size_t(place_[j]);
      T* c = f.band.column(to) + upper_ - to;
      std::fill_n(c + to - upper_, lower_ + upper_ + 1, T(0));
      for_column(j, [&](size_t i, size_t k) { c[size_t(place_[i])] = entry(k); });
      c[to] += T(1);
    }
  }
  return f.band.factor();
}

bool NewtonMatrix::factor(double z) {
  z_ = z;
  if (own_) return own_->factor(z);
  return second_order_ ? assemble_and_factor(real_, z * z, z) : assemble_and_factor(real_, z, 0.0);
}
bool NewtonMatrix::factor(Complex z) {
  z_complex_ = z;
  if (own_) return own_->factor(z);
  return second_order_ ? assemble_and_factor(complex_, z * z, z)
                       : assemble_and_factor(complex_, z, Complex{});
}
bool NewtonMatrix::factor_second_order(double with_x, double with_v) {
  if (own_) return own_->factor_second_order(with_x, with_v);
  return assemble_and_factor(real_, with_x, with_v);
}

// With the factorised matrix itself, in place.
template <class T>
void NewtonMatrix::solve_reduced(Factors<T>& f, T* b) {
  if (kind_ == Kind::dense) return f.dense.solve(b);
  if (kind_ == Kind::sparse) return sparse_->solve(b);
  if (order_.empty()) return f.band.solve(b);
  T* r = f.permuted.data();
  for (size_t k = 0; k < m_; ++k) r[k] = b[size_t(order_[k])];
  f.band.solve(r);
  for (size_t k = 0; k < m_; ++k) b[size_t(order_[k])] = r[k];
}
void NewtonMatrix::solve_second_order(double* b) {
  if (own_) return own_->solve_second_order(b);
  solve_reduced(real_, b);
}

// y = A x
void NewtonMatrix::multiply_first(const double* x, double* y) const {
  const double* a = first_.data();
  if (shape_.kind == MatrixShape::Kind::banded && shape_.lower == 1 && shape_.upper == 1 && m_ > 1) {
    const size_t n = m_;
    y[0] = a[1] * x[0] + a[3] * x[1];
    for (size_t i = 1; i + 1 < n; ++i) {
      y[i] = a[3 * i - 1] * x[i - 1] + a[3 * i + 1] * x[i] + a[3 * i + 3] * x[i + 1];
    }
    y[n - 1] = a[3 * n - 4] * x[n - 2] + a[3 * n - 2] * x[n - 1];
    return;
  }
  std::fill_n(y, m_, 0.0);
  for (size_t j = 0; j < m_; ++j) {
    const double xj = x[j];
    for_column(j, [&](size_t i, size_t k) { y[i] += a[k] * xj; });
  }
}

void NewtonMatrix::solve(double* b) {
  if (own_) return own_->solve(b);
  if (!second_order_) return solve_reduced(real_, b);
  double *r = b, *s = b + m_;
  double* product = product_.data();
  multiply_first(r, product);
  const double z = z_;
#pragma GCC ivdep
  for (size_t i = 0; i < m_; ++i) s[i] += z * product[i];
  solve_reduced(real_, s);
#pragma GCC ivdep
  for (size_t i = 0; i < m_; ++i) r[i] += z * s[i];
}

void NewtonMatrix::solve(double* re, double* im) {
  if (own_) return own_->solve(re, im);
  const Complex z = z_complex_;
  const size_t offset = second_order_ ? m_ : 0;
  complex_rhs_.resize(m_);
  Complex* q = complex_rhs_.data();
  for (size_t i = 0; i < m_; ++i) q[i] = {re[offset + i], im[offset + i]};
  if (second_order_) {
    double* product = product_.data();
    multiply_first(re, product);
    for (size_t i = 0; i < m_; ++i) q[i] += product[i] * z;
    multiply_first(im, product);
    for (size_t i = 0; i < m_; ++i) q[i] += Complex{-z.im * product[i], z.re * product[i]};
  }
  solve_reduced(complex_, q);
  for (size_t i = 0; i < m_; ++i) re[offset + i] = q[i].re, im[offset + i] = q[i].im;
  if (!second_order_) return;
  for (size_t i = 0; i < m_; ++i) {
    const Complex p = z * q[i];
    re[i] += p.re, im[i] += p.im;
  }
}

}  // namespace truestep
