// The cost of an implicit step from the pattern of its matrix: the fill is that of a factorization by Eigen,
// and the predicted cost of a large net is that of its factors.
#include "engine/integrators/control/step_work.h"
#include "engine/integrators/table/integrators.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>

#include "engine/integrators/implicit/newton_matrix.h"
#include "engine/math/solvers/symbolic_fill.h"

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
    EXPECT_NEAR((work.solve + double(net.size())) / 2, nonzeros, 0.05 * nonzeros) << nx << " x " << ny;
  }
}

TEST(StepWork, ALargeNetCostsWhatItsFactorsCost) {
  const Net small(10, 10, 1), large(60, 60, 1);
  const Integrator& method = *find_integrator("implicit_midpoint");
  const auto work = [&](const Net& net) {
    return implicit_step_work(method, net, net.operations(), 1e-3, net.start().data(), {}).value();
  };
  const StepWork a = work(small), b = work(large);
  EXPECT_DOUBLE_EQ(b.rate / a.rate, (large.operations() + 3600) / (small.operations() + 100));
  // With 36 times the unknowns a factorization takes at least 36^(3/2) = 216 times as long, in whatever
  // order.
  EXPECT_GT(b.factorisation, 100 * a.factorisation);
  EXPECT_GT(b.operations(), b.factorisation);
}

TEST(StepWork, ExplicitMethodsHaveNone) {
  const Net f(2, 2, 1);
  const std::vector<double> y(4, 0.5);
  EXPECT_FALSE(implicit_step_work(*find_integrator("rk4"), f, 10, 1, y.data(), {}));
}

}  // namespace
}  // namespace truestep
