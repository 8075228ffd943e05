// (I - z J) x = b for every shape of the Jacobian, real and complex, first and second order, own derivatives
// and differences: against Eigen's dense solution of the whole system.
#include "engine/integrators/implicit/newton/newton_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>

namespace truestep {
namespace {

enum class Derivatives : uint8_t { own, differences };
enum class Order : uint8_t { first, second };

// Points on a ring or in a row with nonlinear forces between neighbours, y as one long vector (first order)
// or as positions and velocities (second).
class Neighbours final : public RightHandSide, public SecondOrder {
 public:
  Neighbours(size_t n, MatrixShape::Kind kind, Order order, Derivatives derivatives)
      : n_(n), kind_(kind), order_(order), derivatives_(derivatives) {
    for (size_t j = 0; j < n; ++j) {
      start_.push_back(int32_t(rows_.size()));
      for (size_t i = 0; i < n; ++i) {
        if (i == j || i + 1 == j || j + 1 == i) rows_.push_back(int32_t(i));
      }
    }
    start_.push_back(int32_t(rows_.size()));
  }

  size_t size() const override { return order_ == Order::second ? 2 * n_ : n_; }
  const SecondOrder* second_order() const override { return order_ == Order::second ? this : nullptr; }
  bool has_jacobian() const override { return derivatives_ == Derivatives::own; }
  bool depends_on_velocity() const override { return true; }
  MatrixShape jacobian_shape() const override { return shape(); }
  MatrixShape shape() const override {
    switch (kind_) {
      case MatrixShape::Kind::dense:
        return {};
      case MatrixShape::Kind::banded:
        return {.kind = kind_, .lower = 1, .upper = 1, .column_start = {}, .rows = {}};
      default:
        return {.kind = kind_, .column_start = start_, .rows = rows_};
    }
  }
  void rate(double t, const double* y, double* dydt) const override {
    if (order_ == Order::first) return acceleration(t, y, y, dydt);
    std::copy_n(y + n_, n_, dydt);
    acceleration(t, y, y + n_, dydt + n_);
  }
  void acceleration(double, const double* x, const double* v, double* a) const override {
    for (size_t i = 0; i < n_; ++i) {
      const double before = i > 0 ? x[i - 1] : 0, after = i + 1 < n_ ? v[i + 1] : 0;
      a[i] = -3 * x[i] * x[i] + before * x[i] + 0.5 * after - 0.25 * v[i];
    }
  }
  void jacobian(double, const double* x, const double*, double* dadx, double* dadv) const override {
    for (size_t i = 0; i < n_; ++i) {
      const double before = i > 0 ? x[i - 1] : 0;
      set(dadx, i, i, -6 * x[i] + before), set(dadv, i, i, -0.25);
      if (i > 0) set(dadx, i, i - 1, x[i]), set(dadv, i, i - 1, 0);
      if (i + 1 < n_) set(dadx, i, i + 1, 0), set(dadv, i, i + 1, 0.5);
    }
  }
  void jacobian(double t, const double* y, double* values) const override {
    std::vector<double> v(shape().values(n_));
    std::fill_n(values, v.size(), 0.0);
    jacobian(t, y, y, values, v.data());
    for (size_t k = 0; k < v.size(); ++k) values[k] += v[k];
  }

 private:
  void set(double* values, size_t i, size_t j, double value) const {
    if (kind_ == MatrixShape::Kind::dense) {
      values[j * n_ + i] = value;
    } else if (kind_ == MatrixShape::Kind::banded) {
      values[3 * j + 1 + i - j] = value;
    } else {
      for (int32_t k = start_[j]; k < start_[j + 1]; ++k) {
        if (rows_[size_t(k)] == int32_t(i)) values[k] = value;
      }
    }
  }
  size_t n_;
  MatrixShape::Kind kind_;
  Order order_;
  Derivatives derivatives_;
  std::vector<int32_t> start_, rows_;
};

std::vector<double> some_numbers(size_t n, double phase) {
  std::vector<double> y(n);
  for (size_t i = 0; i < n; ++i) y[i] = std::sin(phase + 1.7 * double(i));
  return y;
}

// df/dy by central differences, column by column.
Eigen::MatrixXd dense_jacobian(const RightHandSide& f, const std::vector<double>& y) {
  const size_t n = f.size();
  Eigen::MatrixXd j(n, n);
  std::vector<double> moved = y, up(n), down(n);
  for (size_t c = 0; c < n; ++c) {
    const double h = 1e-5;
    moved[c] = y[c] + h, f.rate(0, moved.data(), up.data());
    moved[c] = y[c] - h, f.rate(0, moved.data(), down.data());
    moved[c] = y[c];
    for (size_t r = 0; r < n; ++r) j(long(r), long(c)) = (up[r] - down[r]) / (2 * h);
  }
  return j;
}

struct Variant {
  size_t n;
  MatrixShape::Kind shape;
  Order order;
  Derivatives derivatives;
  NewtonMatrix::Kind kind;
};
constexpr auto kDense = MatrixShape::Kind::dense, kBand = MatrixShape::Kind::banded,
               kSparse = MatrixShape::Kind::sparse;
const Variant kVariants[] = {
    {10, kDense, Order::first, Derivatives::own, NewtonMatrix::Kind::dense},
    {10, kDense, Order::second, Derivatives::differences, NewtonMatrix::Kind::dense},
    {12, kBand, Order::first, Derivatives::own, NewtonMatrix::Kind::dense},
    {60, kBand, Order::first, Derivatives::differences, NewtonMatrix::Kind::band},
    {60, kBand, Order::second, Derivatives::own, NewtonMatrix::Kind::band},
    {20, kSparse, Order::second, Derivatives::own, NewtonMatrix::Kind::dense},
    {60, kSparse, Order::first, Derivatives::own, NewtonMatrix::Kind::band},
    {60, kSparse, Order::second, Derivatives::differences, NewtonMatrix::Kind::band},
};

// Differences of second derivatives near 6 with steps of 1e-8 leave 1e-7; analytic derivatives are compared
// with central differences (1e-10).
double tolerance_of(Derivatives d) {
  return d == Derivatives::own ? 1e-8 : 1e-6;
}

TEST(NewtonMatrix, SolvesTheWholeSystemInEveryShape) {
  for (const Variant& v : kVariants) {
    const Neighbours f(v.n, v.shape, v.order, v.derivatives);
    const size_t n = f.size();
    const auto y = some_numbers(n, 0.3);
    std::vector<double> fy(n);
    f.rate(0, y.data(), fy.data());
    NewtonMatrix m;
    m.bind(f);
    EXPECT_EQ(m.kind(), v.kind);
    EXPECT_EQ(m.unknowns(), v.n);
    Statistics count;
    m.differentiate(0, y.data(), fy.data(), 1, count);
    if (v.shape != kDense && v.derivatives == Derivatives::differences) {
      // Three columns overlap: three or four groups, not one evaluation per column.
      EXPECT_LE(count.rates, 8u);
    }
    const Eigen::MatrixXd j = dense_jacobian(f, y), one = Eigen::MatrixXd::Identity(long(n), long(n));
    const auto b = some_numbers(n, 1), c = some_numbers(n, 2);
    auto x = b, im = c;

    const double z = 0.2;
    ASSERT_TRUE(m.factor(z));
    m.solve(x.data());
    const Eigen::VectorXd want =
        (one - z * j).fullPivLu().solve(Eigen::Map<const Eigen::VectorXd>(b.data(), long(n)));
    const double size = want.norm();
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), long(n)) - want).norm(),
              tolerance_of(v.derivatives) * size);
    // Control: another z has another solution.
    EXPECT_GT(
        ((one - 0.21 * j).fullPivLu().solve(Eigen::Map<const Eigen::VectorXd>(b.data(), long(n))) - want)
            .norm(),
        1e-4 * size);

    x = b;
    ASSERT_TRUE(m.factor(Complex{0.1, -0.15}));
    m.solve(x.data(), im.data());
    Eigen::VectorXcd right{long(n)};
    for (size_t i = 0; i < n; ++i) right[long(i)] = {b[i], c[i]};
    const Eigen::VectorXcd both =
        (one.cast<std::complex<double>>() - std::complex<double>(0.1, -0.15) * j).fullPivLu().solve(right);
    double worst = 0;
    for (size_t i = 0; i < n; ++i) {
      worst = std::max(worst, std::abs(both[long(i)] - std::complex<double>(x[i], im[i])));
    }
    EXPECT_LT(worst, tolerance_of(v.derivatives) * both.norm());
  }
}

// A torus: no order of its points gives a narrow band.
class Torus final : public RightHandSide {
 public:
  explicit Torus(size_t side) : side_(side) {
    for (size_t j = 0; j < size(); ++j) {
      start_.push_back(int32_t(rows_.size()));
      std::vector<int32_t> c = {int32_t(j)};
      for (const size_t k : around(j)) c.push_back(int32_t(k));
      std::sort(c.begin(), c.end());
      rows_.insert(rows_.end(), c.begin(), c.end());
    }
    start_.push_back(int32_t(rows_.size()));
  }
  size_t size() const override { return side_ * side_; }
  MatrixShape jacobian_shape() const override {
    return {.kind = MatrixShape::Kind::sparse, .column_start = start_, .rows = rows_};
  }
  void rate(double, const double* y, double* d) const override {
    for (size_t i = 0; i < size(); ++i) {
      d[i] = -4 * y[i];
      for (const size_t k : around(i)) d[i] += y[k];
    }
  }
  std::array<size_t, 4> around(size_t i) const {
    const size_t x = i % side_, y = i / side_, s = side_;
    return {(x + 1) % s + y * s, (x + s - 1) % s + y * s, x + (y + 1) % s * s, x + (y + s - 1) % s * s};
  }

 private:
  size_t side_;
  std::vector<int32_t> start_, rows_;
};

TEST(NewtonMatrix, LargePatternsWithoutABandAreFactorisedSparsely) {
  const Torus f(100);
  const size_t n = f.size();
  const auto y = some_numbers(n, 0.1), b = some_numbers(n, 0.5);
  std::vector<double> fy(n), x = b, im(n, 0.0), product(n);
  f.rate(0, y.data(), fy.data());
  NewtonMatrix m;
  m.bind(f);
  EXPECT_EQ(m.kind(), NewtonMatrix::Kind::sparse);
  Statistics count;
  m.differentiate(0, y.data(), fy.data(), 1, count);
  EXPECT_LE(count.rates, 20u);
  ASSERT_TRUE(m.factor(0.7));
  m.solve(x.data());
  // f is linear: x - z f(x) = b, to the error of differences.
  f.rate(0, x.data(), product.data());
  for (size_t i = 0; i < n; ++i) EXPECT_NEAR(x[i] - 0.7 * product[i], b[i], 1e-6);
  x = b;
  ASSERT_TRUE(m.factor(Complex{0, 0.7}));
  m.solve(x.data(), im.data());
  // (I - i z L)(x + i w) = b: real part x + z L w.
  f.rate(0, im.data(), product.data());
  for (size_t i = 0; i < n; ++i) EXPECT_NEAR(x[i] + 0.7 * product[i], b[i], 1e-6);
}

}  // namespace
}  // namespace truestep
