// Both libraries agree with dense elimination, report singular matrices and forget every matrix but the last;
// CVODE's BDF runs on them.
#include "engine/math/solvers/sparse/sparse_lu.h"
#include "engine/integrators/table/integrators.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "engine/base/errors.h"
#include "engine/core/equations/integrator.h"
#include "engine/integrators/advance.h"

namespace truestep {
namespace {

/// That of the program and, where it is installed, the other (tests/CMakeLists.txt).
template <class T>
std::vector<std::unique_ptr<SparseLu<T>>> libraries() {
  std::vector<std::unique_ptr<SparseLu<T>>> all;
  for (auto make : {TRUESTEP_SPARSE_LIBRARIES}) all.push_back(make());
  return all;
}

/// Five-point star with a twist that makes it unsymmetric, on a ring of n by n points.
struct Ring {
  explicit Ring(int side) : n(side * side) {
    for (int j = 0; j < n; ++j) {
      std::vector<int> column = {j, (j + 1) % n, (j + n - 1) % n, (j + side) % n, (j + 3 * side) % n};
      std::sort(column.begin(), column.end());
      column.erase(std::unique(column.begin(), column.end()), column.end());
      rows.insert(rows.end(), column.begin(), column.end());
      start.push_back(static_cast<int>(rows.size()));
    }
  }
  int n;
  std::vector<int> start{0}, rows;
};

template <class T>
T number(int k, double turn);
template <>
double number(int k, double turn) {
  return std::sin(turn * k + 0.3);
}
template <>
std::complex<double> number(int k, double turn) {
  return {std::sin(turn * k + 0.3), std::cos(1.7 * turn * k)};
}
template <class T>
std::vector<T> numbers(size_t count, double turn) {
  std::vector<T> v(count);
  for (size_t k = 0; k < count; ++k) v[k] = number<T>(static_cast<int>(k), turn);
  return v;
}

template <class T>
class SparseLuOf : public ::testing::Test {};
using Scalars = ::testing::Types<double, std::complex<double>>;
TYPED_TEST_SUITE(SparseLuOf, Scalars);

TYPED_TEST(SparseLuOf, SolvesWhatDenseEliminationSolves) {
  using T = TypeParam;
  const Ring ring(8);
  const auto values = numbers<T>(ring.rows.size(), 2.4), b = numbers<T>(static_cast<size_t>(ring.n), 0.9);
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> dense =
      Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>::Zero(ring.n, ring.n);
  for (int j = 0; j < ring.n; ++j) {
    for (int k = ring.start[size_t(j)]; k < ring.start[size_t(j) + 1]; ++k) {
      dense(ring.rows[size_t(k)], j) = values[size_t(k)];
    }
  }
  const Eigen::Matrix<T, Eigen::Dynamic, 1> expected =
      dense.partialPivLu().solve(Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, 1>>(b.data(), ring.n));
  for (const auto& lu : libraries<T>()) {
    lu->analyse(ring.n, ring.start.data(), ring.rows.data());
    ASSERT_TRUE(lu->factor(values.data()));
    auto x = b;
    lu->solve(x.data());
    // Condition numbers up to some 1e4.
    for (int i = 0; i < ring.n; ++i) EXPECT_LT(std::abs(x[size_t(i)] - expected[i]), 1e-10);
  }
}

TYPED_TEST(SparseLuOf, RemembersNothingOfEarlierMatrices) {
  using T = TypeParam;
  const Ring ring(8);
  const auto first = numbers<T>(ring.rows.size(), 2.4), other = numbers<T>(ring.rows.size(), 1.1),
             b = numbers<T>(static_cast<size_t>(ring.n), 0.9);
  const auto all = libraries<T>(), again = libraries<T>();
  for (size_t k = 0; k < all.size(); ++k) {
    SparseLu<T>*const fresh = all[k].get(), *const used = again[k].get();
    for (SparseLu<T>* lu : {fresh, used}) lu->analyse(ring.n, ring.start.data(), ring.rows.data());
    auto x = b, y = b;
    ASSERT_TRUE(used->factor(other.data()));
    used->solve(y.data());
    EXPECT_NE(x, y) << "control: another matrix, another solution";
    y = b;
    ASSERT_TRUE(fresh->factor(first.data()) && used->factor(first.data()));
    fresh->solve(x.data()), used->solve(y.data());
    EXPECT_EQ(x, y) << "to the last bit";
  }
}

TYPED_TEST(SparseLuOf, ASingularMatrixIsRefused) {
  using T = TypeParam;
  const Ring ring(6);
  auto values = numbers<T>(ring.rows.size(), 2.4);
  for (int k = ring.start[7]; k < ring.start[8]; ++k) values[size_t(k)] = T(0);
  for (const auto& lu : libraries<T>()) {
    lu->analyse(ring.n, ring.start.data(), ring.rows.data());
    EXPECT_FALSE(lu->factor(values.data()));
    EXPECT_TRUE(lu->factor(numbers<T>(ring.rows.size(), 2.4).data())) << "control";
  }
}

/// Heat on a square with a source that grows with it, u' = D Lap u + u (1 - u): sparse, first order.
class Spreading final : public RightHandSide {
 public:
  explicit Spreading(size_t side) : side_(side) {
    for (size_t p = 0; p < size(); ++p) {
      each_neighbour(p, [&](size_t q) { rows_.push_back(int32_t(q)); });
      start_.push_back(int32_t(rows_.size()));
    }
  }
  size_t size() const override { return side_ * side_; }
  bool autonomous() const override { return true; }
  void rate(double, const double* y, double* d) const override {
    for (size_t p = 0; p < size(); ++p) {
      d[p] = y[p] * (1 - y[p]);
      each_neighbour(p, [&](size_t q) { d[p] += kSpread * (y[q] - y[p]); });
    }
  }
  MatrixShape jacobian_shape() const override {
    return {.kind = MatrixShape::Kind::sparse, .column_start = start_, .rows = rows_};
  }
  bool has_jacobian() const override { return true; }
  void jacobian(double, const double* y, double* values) const override {
    for (size_t p = 0; p < size(); ++p) {
      double out = 0;
      each_neighbour(p, [&](size_t q) { out += q != p; });
      each_neighbour(p, [&](size_t q) { *values++ = q == p ? 1 - 2 * y[p] - kSpread * out : kSpread; });
    }
  }

 private:
  static constexpr double kSpread = 400;
  template <class Use>
  void each_neighbour(size_t p, Use use) const {
    const size_t x = p % side_, y = p / side_;
    if (y > 0) use(p - side_);
    if (x > 0) use(p - 1);
    use(p);
    if (x + 1 < side_) use(p + 1);
    if (y + 1 < side_) use(p + side_);
  }
  size_t side_;
  std::vector<int32_t> start_{0}, rows_;
};

TEST(SparseLu, CvodeRunsOnOurFactors) {
  const Spreading f(20);
  const auto run = [&](const char* method) {
    Workspace workspace;
    Carry carry;
    Statistics count;
    std::vector<double> y(f.size(), 0.01);
    y[f.size() / 2] = 1;
    Advance in{.f = f,
               .t = 0,
               .t_end = 3,
               .y = y.data(),
               .workspace = workspace,
               .carry = carry,
               .tolerance = {1e-8, 1e-10}};
    in.statistics = &count;
    find_integrator(method)->advance(in);
    // Without the derivatives a step costs hundreds of evaluations.
    EXPECT_LT(count.rates, 3000u) << method;
    return y;
  };
  const auto cvode = run("cvode_bdf"), radau = run("radau5");
  // CVODE stays within some hundred tolerances.
  for (size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(cvode[i], radau[i], 1e-6);
  EXPECT_GT(radau[0], 0.05) << "control: something has happened";
}

}  // namespace
}  // namespace truestep
