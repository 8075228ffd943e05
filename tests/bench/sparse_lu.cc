// KLU beside Eigen's SparseLU, of which a program has one (math/solvers/sparse/sparse_lu.h), on the Newton
// matrices I - z J of implicit methods, real and complex, one factorisation and one solution: a chain of
// 1,000 masses and the Brusselator on a grid of 64 x 64 points.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "engine/math/solvers/sparse/sparse_lu.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;

struct Pattern {
  const char* name;
  size_t n = 0;
  std::vector<int32_t> start{0}, rows;
  std::vector<double> values;
  void end_column() { start.push_back(int32_t(rows.size())); }
  void entry(size_t row, double value) { rows.push_back(int32_t(row)), values.push_back(value); }
};

// da/dx of unit masses between springs of 1e8 N/m.
Pattern chain() {
  Pattern p{.name = "chain of 1,000 masses", .n = 1000};
  for (size_t j = 0; j < p.n; ++j) {
    if (j > 0) p.entry(j - 1, 1e8);
    p.entry(j, -2e8);
    if (j + 1 < p.n) p.entry(j + 1, 1e8);
    p.end_column();
  }
  return p;
}

// u' = 1 + u^2 v - 4.4 u + a Lap u, v' = 3.4 u - u^2 v + a Lap v (Hairer, Wanner 1996, section IV.10) at u =
// v = 1, unknowns u and v of a point side by side.
Pattern brusselator() {
  constexpr size_t kSide = 64;
  constexpr double kSpread = 0.1 * (kSide - 1) * (kSide - 1);
  Pattern p{.name = "Brusselator 64 x 64", .n = 2 * kSide * kSide};
  const double local[2][2] = {{2 - 4.4, 1}, {3.4 - 2, -1}};
  for (size_t point = 0; point < kSide * kSide; ++point) {
    const size_t x = point % kSide, y = point / kSide;
    for (size_t c = 0; c < 2; ++c) {
      if (y > 0) p.entry(2 * (point - kSide) + c, kSpread);
      if (x > 0) p.entry(2 * (point - 1) + c, kSpread);
      for (size_t r = 0; r < 2; ++r) p.entry(2 * point + r, local[r][c] - (r == c ? 4 * kSpread : 0));
      if (x + 1 < kSide) p.entry(2 * (point + 1) + c, kSpread);
      if (y + 1 < kSide) p.entry(2 * (point + kSide) + c, kSpread);
      p.end_column();
    }
  }
  return p;
}

template <class T>
void compare(const Pattern& p, T z, const char* kind) {
  // I - z J; every column has an entry on the diagonal.
  std::vector<T> matrix(p.values.size());
  for (size_t j = 0; j < p.n; ++j) {
    for (auto k = size_t(p.start[j]); k < size_t(p.start[j + 1]); ++k) {
      matrix[k] = T(size_t(p.rows[k]) == j ? 1 : 0) - z * p.values[k];
    }
  }
  const auto klu = make_klu_lu<T>(), eigen = make_eigen_lu<T>();
  std::vector<T> x(p.n), y(p.n);
  const auto run = [&](SparseLu<T>& lu, std::vector<T>& b) {
    for (size_t i = 0; i < p.n; ++i) b[i] = T(std::cos(double(i)));
    lu.factor(matrix.data());
    lu.solve(b.data());
  };
  for (SparseLu<T>* lu : {klu.get(), eigen.get()}) lu->analyse(int(p.n), p.start.data(), p.rows.data());
  const auto both = bench::paired(
      15, [&] { run(*klu, x); }, [&] { run(*eigen, y); }, bench::thread_seconds);
  double apart = 0, largest = 0;
  for (size_t i = 0; i < p.n; ++i) {
    apart = std::max(apart, std::abs(x[i] - y[i])), largest = std::max(largest, std::abs(x[i]));
  }
  std::fprintf(stderr, "%s, %s: klu/eigen %.3f (%.3f to %.3f), %.1e apart\n", p.name, kind, both.middle,
               both.low, both.high, apart / largest);
  bench::report({.bench = "sparse_lu",
                 .metric = std::string("CPU seconds, factor and solve, ") + p.name + ", " + kind,
                 .ours = both.times.ours,
                 .peer = both.times.peer,
                 .peer_name = "Eigen SparseLU"});
}

}  // namespace

int main() {
  for (const Pattern& p : {chain(), brusselator()}) {
    compare(p, 1e-4, "real");
    compare(p, std::complex<double>(1e-4, 7e-5), "complex");
  }
}
