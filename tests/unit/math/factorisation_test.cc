// Dense, band and small factorizations against Eigen's, real and complex, with and without row exchanges;
// reordering and grouping of sparse patterns.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <complex>
#include <numeric>

#include "engine/math/solvers/band_lu.h"
#include "engine/math/solvers/dense_lu.h"
#include "engine/math/solvers/reordering.h"
#include "engine/math/solvers/small_lu.h"

namespace truestep {
namespace {

// Random matrices of this size have condition numbers up to some 1e4: 1e-16 of rounding grows to 1e-11.
constexpr double kTolerance = 1e-10;

uint64_t next_number = 1;
double random_number() {
  // A linear congruential generator is enough to fill matrices (Knuth's constants).
  next_number = next_number * 6364136223846793005u + 1442695040888963407u;
  return double(next_number >> 11) * 0x1p-52 - 1;
}

template <class T>
struct Of;
template <>
struct Of<double> {
  using Eigen = double;
  static double make() { return random_number(); }
  static double to(double x) { return x; }
};
template <>
struct Of<Complex> {
  using Eigen = std::complex<double>;
  static Complex make() { return {random_number(), random_number()}; }
  static std::complex<double> to(Complex z) { return {z.re, z.im}; }
};

template <class T>
using EigenMatrix = Eigen::Matrix<typename Of<T>::Eigen, Eigen::Dynamic, Eigen::Dynamic>;
template <class T>
using EigenVector = Eigen::Matrix<typename Of<T>::Eigen, Eigen::Dynamic, 1>;

template <class T>
EigenVector<T> eigen(const std::vector<T>& v) {
  EigenVector<T> e(long(v.size()));
  for (size_t i = 0; i < v.size(); ++i) e[long(i)] = Of<T>::to(v[i]);
  return e;
}

template <class T>
std::vector<T> random_vector(size_t n) {
  std::vector<T> v(n);
  for (T& x : v) x = Of<T>::make();
  return v;
}

// Difference to Eigen's solution, relative to it.
template <class T>
double difference(const EigenMatrix<T>& a, const std::vector<T>& b, const std::vector<T>& x) {
  const EigenVector<T> want = a.fullPivLu().solve(eigen(b));
  return (eigen(x) - want).norm() / want.norm();
}

template <class T, int N>
void check_small() {
  for (int turn = 0; turn < 20; ++turn) {
    SmallLu<T, N> lu;
    EigenMatrix<T> a(N, N);
    for (int k = 0; k < N * N; ++k) {
      lu.matrix()[k] = Of<T>::make();
      // Zeros on the diagonal force exchanges.
      if (N > 1 && turn % 2 && k % (N + 1) == 0) lu.matrix()[k] = T(0);
      a(k % N, k / N) = Of<T>::to(lu.matrix()[k]);
    }
    ASSERT_TRUE(lu.factor());
    const auto b = random_vector<T>(N);
    auto x = b;
    lu.solve(x.data());
    EXPECT_LT(difference<T>(a, b, x), kTolerance) << N;
  }
  SmallLu<T, N> zero;
  std::fill_n(zero.matrix(), N * N, T(0));
  EXPECT_FALSE(zero.factor());
}

TEST(SmallLu, AgreesWithEigenInEverySize) {
  check_small<double, 1>(), check_small<double, 2>(), check_small<double, 3>(), check_small<double, 4>();
  check_small<double, 5>(), check_small<double, 6>(), check_small<double, 7>(), check_small<double, 8>();
  check_small<Complex, 1>(), check_small<Complex, 2>(), check_small<Complex, 3>(), check_small<Complex, 4>();
  check_small<Complex, 7>(), check_small<Complex, 8>();
}

template <class T>
void check_dense(size_t n) {
  DenseLu<T> lu;
  lu.resize(n);
  EigenMatrix<T> a{long(n), long(n)};
  for (size_t k = 0; k < n * n; ++k) {
    lu.matrix()[k] = Of<T>::make();
    a(long(k % n), long(k / n)) = Of<T>::to(lu.matrix()[k]);
  }
  ASSERT_TRUE(lu.factor()) << n;
  const auto b = random_vector<T>(n);
  auto x = b;
  lu.solve(x.data());
  EXPECT_LT(difference<T>(a, b, x), kTolerance) << n;
}

TEST(DenseLu, AgreesWithEigenAroundTheWidthOfAPanel) {
  for (const size_t n : {1, 2, 3, 4, 5, 7, 8, 9, 16, 31, 80}) check_dense<double>(n), check_dense<Complex>(n);
}

TEST(DenseLu, SaysThatAMatrixIsSingular) {
  DenseLu<double> lu;
  lu.resize(6);
  for (size_t k = 0; k < 36; ++k) lu.matrix()[k] = double(k % 6);  // equal columns
  EXPECT_FALSE(lu.factor());
}

template <class T>
void check_band(size_t n, size_t lower, size_t upper, T diagonal) {
  BandLu<T> lu;
  lu.resize(n, lower, upper);
  EigenMatrix<T> a = EigenMatrix<T>::Zero(long(n), long(n));
  for (size_t j = 0; j < n; ++j) {
    for (size_t k = 0; k <= lower + upper; ++k) {
      if (j + k < upper || j + k - upper >= n) continue;
      const size_t i = j + k - upper;
      const T value = i == j ? diagonal : Of<T>::make();
      lu.column(j)[k] = value;
      a(long(i), long(j)) = Of<T>::to(value);
    }
  }
  ASSERT_TRUE(lu.factor()) << n << ' ' << lower << ' ' << upper;
  const auto b = random_vector<T>(n);
  auto x = b;
  lu.solve(x.data());
  EXPECT_LT(difference<T>(a, b, x), kTolerance) << n << ' ' << lower << ' ' << upper;
}

TEST(BandLu, AgreesWithEigenWithAndWithoutExchanges) {
  for (const double diagonal : {4.0, 0.01}) {
    for (const size_t n : {4, 20, 61}) {
      for (const size_t lower : {1, 2, 3}) {
        for (const size_t upper : {1, 2, 3}) {
          check_band<double>(n, lower, upper, diagonal);
          check_band<Complex>(n, lower, upper, {diagonal, -0.3 * diagonal});
        }
      }
    }
  }
}

// The pattern of a row of points with neighbours two away, in a shuffled order.
struct Pattern {
  std::vector<int32_t> start, rows;
};
Pattern shuffled_row(size_t n) {
  std::vector<size_t> place(n);
  std::iota(place.begin(), place.end(), 0);
  for (size_t i = n; i-- > 1;) std::swap(place[i], place[size_t((random_number() + 1) / 2 * double(i))]);
  std::vector<std::vector<int32_t>> columns(n);
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = i < 2 ? 0 : i - 2; j < std::min(n, i + 3); ++j) {
      columns[place[j]].push_back(int32_t(place[i]));
    }
  }
  Pattern p{{0}, {}};
  for (auto& c : columns) {
    std::sort(c.begin(), c.end());
    p.rows.insert(p.rows.end(), c.begin(), c.end());
    p.start.push_back(int32_t(p.rows.size()));
  }
  return p;
}

TEST(Reordering, FindsTheRowInAShuffledPattern) {
  const Pattern p = shuffled_row(200);
  const ColumnPattern columns{p.start, p.rows};
  std::vector<int32_t> as_it_is(200);
  std::iota(as_it_is.begin(), as_it_is.end(), 0);
  EXPECT_GT(bandwidth(columns, as_it_is).lower, 100u);
  const auto order = reverse_cuthill_mckee(columns);
  auto sorted = order;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, as_it_is);
  // Levels of breadth-first search hold two points each: at most three apart.
  EXPECT_LE(bandwidth(columns, order).lower, 3u);
  EXPECT_LE(bandwidth(columns, order).upper, 3u);
}

TEST(Reordering, ColumnsOfAGroupShareNoRow) {
  const Pattern p = shuffled_row(200);
  const ColumnGroups g = group_columns({p.start, p.rows});
  // Five columns meet in a row, so five groups are needed; greedy takes a few more.
  EXPECT_GE(g.groups, 5);
  EXPECT_LE(g.groups, 10);
  for (int32_t group = 0; group < g.groups; ++group) {
    std::vector<int> seen(200, 0);
    for (size_t j = 0; j < 200; ++j) {
      if (g.group[j] != group) continue;
      for (int32_t k = p.start[j]; k < p.start[j + 1]; ++k) EXPECT_EQ(seen[size_t(p.rows[size_t(k)])]++, 0);
    }
  }
}

}  // namespace
}  // namespace truestep
