// What a step of an implicit method is expected to cost is within a factor of three of what it is counted to
// do: evaluations, derivatives, factorisations and solves, each weighed with its own operations. Operations,
// not seconds: they are the same on every machine. The fill of sparse factors is checked against Eigen's.
#include "engine/integrators/step_work.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>

#include "engine/integrators/newton_matrix.h"
#include "engine/math/solvers/symbolic_fill.h"
#include "tests/support/stiff_problems.h"

namespace truestep {
namespace {

/// Diffusion with a reaction on a grid of nx x ny points: y' = k (sum of neighbours - 4 y) + y (1 - y) ...
class Net final : public RightHandSide {
 public:
  Net(int nx, int ny, double k) : nx_(nx), ny_(ny), k_(k) {
    start_.push_back(0);
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        for (const auto& [di, dj] : {std::pair{0, -1}, {-1, 0}, {0, 0}, {1, 0}, {0, 1}}) {
          if (i + di >= 0 && i + di < nx && j + dj >= 0 && j + dj < ny)
            rows_.push_back((j + dj) * nx + i + di);
        }
        start_.push_back(static_cast<int32_t>(rows_.size()));
      }
    }
  }
  size_t size() const override { return static_cast<size_t>(nx_ * ny_); }
  bool autonomous() const override { return true; }
  void rate(double, const double* y, double* d) const override {
    for (size_t c = 0; c < size(); ++c) {
      double sum = 0;
      for (int32_t k = start_[c]; k < start_[c + 1]; ++k) sum += y[rows_[size_t(k)]] - y[c];
      d[c] = k_ * sum + y[c] * (1 - y[c]);
    }
  }
  MatrixShape jacobian_shape() const override {
    return {.kind = MatrixShape::Kind::sparse, .column_start = start_, .rows = rows_};
  }
  double operations() const { return 3.0 * double(rows_.size()); }
  std::vector<double> start() const {
    std::vector<double> y(size());
    for (size_t c = 0; c < size(); ++c) y[c] = 0.5 + 0.4 * std::sin(0.3 * double(c));
    return y;
  }

 private:
  int nx_, ny_;
  double k_;
  std::vector<int32_t> start_, rows_;
};

/// Predicted over counted operations of a step of h, the mean of `steps` from y.
double ratio(const std::string& name, const RightHandSide& f, double rate, std::vector<double> y, double h,
             int steps) {
  const Integrator& method = *find_integrator(name);
  const Tolerance tolerance{1e-6, 1e-6};
  const auto predicted = implicit_step_work(method, f, rate, h, y.data(), tolerance);
  EXPECT_TRUE(predicted) << name;
  Workspace workspace;
  Carry carry;
  Statistics count;
  std::vector<double> memory(method.memory ? method.memory(f.size()) : 0, NAN);
  for (int k = 0; k < steps; ++k) {
    Advance run{.f = f,
                .t = k * h,
                .t_end = (k + 1) * h,
                .y = y.data(),
                .workspace = workspace,
                .carry = carry,
                .tolerance = tolerance,
                .memory = memory};
    run.statistics = &count;
    method.advance(run);
  }
  StepWork counted = *predicted;
  counted.rates = double(count.rates) / steps, counted.jacobians = double(count.jacobians) / steps;
  counted.factorisations = double(count.factorisations) / steps,
  counted.solves = double(count.solves) / steps;
  const double r = predicted->operations() / counted.operations();
  std::printf(
      "%-18s n %5zu h %-8g ratio %6.2f | rates %6.1f %6.1f jac %5.2f %5.2f fac %5.2f %5.2f sol %6.1f %6.1f\n",
      name.c_str(), f.size(), h, r, predicted->rates, counted.rates, predicted->jacobians, counted.jacobians,
      predicted->factorisations, counted.factorisations, predicted->solves, counted.solves);
  return r;
}

TEST(StepWork, IsWithinAFactorOfThreeOfWhatStepsDo) {
  const Net chain(400, 1, 50), grid(40, 40, 50), wide(90, 90, 20);
  const test::Rober rober;
  const test::VanDerPol oscillator(1e-3);
  for (const char* name :
       {"tr_bdf2", "sdirk4", "rodas5p", "radau5", "implicit_midpoint", "trapezoid", "bdf2"}) {
    const auto holds = [&](const RightHandSide& f, double rate, const std::vector<double>& y, double h,
                           int steps) {
      const double r = ratio(name, f, rate, y, h, steps);
      EXPECT_GT(r, 1.0 / 3) << name << ' ' << f.size() << ' ' << h;
      EXPECT_LT(r, 3) << name << ' ' << f.size() << ' ' << h;
    };
    for (const double h : {0.01, 0.1}) {
      holds(chain, chain.operations(), chain.start(), h, 10);
      holds(grid, grid.operations(), grid.start(), h, 10);
    }
    holds(wide, wide.operations(), wide.start(), 0.1, 3);
    if (find_integrator(name)->stepping == Integrator::Stepping::fixed) continue;
    holds(rober, 10, {1, 0, 0}, 1, 40);
    holds(oscillator, 6, {2, 0}, 0.05, 40);
  }
}

TEST(StepWork, FillIsThatOfAFactorisation) {
  for (const auto& [nx, ny] : {std::pair{60, 1}, {25, 25}, {60, 40}}) {
    const Net net(nx, ny, 1);
    const MatrixShape s = net.jacobian_shape();
    const FactorWork work = symbolic_factor_work({s.column_start, s.rows});
    Eigen::SparseMatrix<double> a(int(net.size()), int(net.size()));
    for (int j = 0; j < int(net.size()); ++j) {
      for (int32_t k = s.column_start[size_t(j)]; k < s.column_start[size_t(j) + 1]; ++k) {
        a.insert(s.rows[size_t(k)], j) = s.rows[size_t(k)] == j ? 10 : -1;
      }
    }
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(a);
    const double nonzeros = double(Eigen::SparseMatrix<double>(factor.matrixL()).nonZeros());
    // L with its diagonal; 2 c + 1 per column counts L, its transpose and the diagonal.
    EXPECT_EQ((work.solve + double(net.size())) / 2, nonzeros) << nx << " x " << ny;
  }
}

TEST(StepWork, ExplicitMethodsHaveNone) {
  const test::Rober f;
  const std::vector<double> y{1, 0, 0};
  EXPECT_FALSE(implicit_step_work(*find_integrator("rk4"), f, 10, 1, y.data(), {}));
}

}  // namespace
}  // namespace truestep
