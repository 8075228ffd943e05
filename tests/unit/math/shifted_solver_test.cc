// Solvers of (shift I - step div(c grad)) x = b on lattices: against dense solves of the operator's own
// matrix, and the contraction of a multigrid cycle.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/lattice/solvers/multigrid.h"
#include "engine/lattice/solvers/spectral_solver.h"

namespace truestep::lattice {
namespace {

const ThreadArena kSerial(1);

std::vector<double> shifted_noise(size_t n, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> between(-1, 1);
  std::vector<double> v(n);
  for (double& x : v) x = between(generator);
  return v;
}

Lattice box(const std::vector<size_t>& cells, const std::vector<std::array<SideKind, 2>>& sides) {
  Lattice l;
  l.dimensions = cells.size();
  for (size_t a = 0; a < cells.size(); ++a) {
    l.axes[a] = {.cells = cells[a], .spacing = 1.0 / double(cells[a])};
    for (size_t e = 0; e < 2; ++e) {
      l.axes[a].sides[e] = {sides[a][e], sides[a][e] == SideKind::robin ? 3.0 : 0.0};
    }
  }
  return l;
}

constexpr auto kD = SideKind::dirichlet, kN = SideKind::neumann, kR = SideKind::robin,
               kP = SideKind::periodic;

// Smooth, between 0.2 and 1.8.
Diffusion varying(const Lattice& l) {
  Coefficient c;
  const auto at = [&](const std::array<size_t, 3>& p, size_t shift) {
    double sum = 0;
    for (size_t a = 0; a < l.dimensions; ++a) {
      sum += (double(p[a]) + (shift == a ? 0.5 : 0)) * l.axes[a].spacing;
    }
    return 1 + 0.8 * std::sin(6.283185307179586 * sum);
  };
  for (size_t i = 0; i < l.nodes(); ++i) c.nodes.push_back(at(l.place(i), 3));
  for (size_t a = 0; a < l.dimensions; ++a) {
    for (size_t i = 0; i < l.nodes(); ++i) c.faces[a].push_back(at(l.place(i), a));
  }
  return Diffusion(l, 2, std::move(c));
}

/// (shift - step L) x, x itself at Dirichlet nodes.
std::vector<double> apply(const Diffusion& d, double shift, double step, const std::vector<double>& x) {
  std::vector<double> y(x.size());
  d.apply(x.data(), y.data(), shift, -step, kSerial);
  for (size_t i = 0; i < x.size(); ++i) {
    if (d.lattice().fixed(d.lattice().place(i))) y[i] = x[i];
  }
  return y;
}

struct ShiftedCase {
  std::vector<size_t> cells;
  std::vector<std::array<SideKind, 2>> sides;
};
const ShiftedCase kConstant[] = {{{17}, {{kD, kN}}},
                                 {{12}, {{kP, kP}}},
                                 {{16, 12}, {{kD, kD}, {kD, kD}}},
                                 {{9, 14}, {{kN, kN}, {kP, kP}}},
                                 {{10, 7}, {{kN, kD}, {kD, kN}}},
                                 {{6, 8, 5}, {{kD, kD}, {kN, kN}, {kP, kP}}},
                                 {{5, 6, 11}, {{kN, kN}, {kD, kN}, {kN, kD}}}};

TEST(SpectralSolver, SolvesWhatTheOperatorSays) {
  for (const ShiftedCase& c : kConstant) {
    for (const int order : {2, 4}) {
      const Diffusion d(box(c.cells, c.sides), order, {0.7, {}, {}});
      ASSERT_TRUE(SpectralSolver::serves(d));
      SpectralSolver solver(d);
      const auto x = shifted_noise(d.lattice().nodes(), 5);
      for (const double step : {1e-4, 0.3, 1e3}) {
        auto b = apply(d, 1, step, x);
        ASSERT_TRUE(solver.factor(1, step));
        solver.solve(b.data(), kSerial);
        double worst = 0;
        for (size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(x[i] - b[i]));
        // Rounding times the condition, at most 1 + 16/3 n^2 sum step.
        const double condition = 1 + step * d.spectral_radius();
        EXPECT_LT(worst, 1e-14 * condition + 1e-13) << c.cells[0] << " " << order << " " << step;
      }
      // Control: another step.
      auto b = apply(d, 1, 0.3, x);
      solver.factor(1, 0.31);
      solver.solve(b.data(), kSerial);
      double worst = 0;
      for (size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(x[i] - b[i]));
      EXPECT_GT(worst, 1e-4);
    }
  }
}

template <class Solver>
void expect_complex(const Diffusion& d, Solver& solver, double tolerance) {
  // (1 - z L)(xr + i xi), z = a + i b, from real products.
  const double a = 0.02, b = -0.05;
  const auto xr = shifted_noise(d.lattice().nodes(), 7), xi = shifted_noise(d.lattice().nodes(), 8);
  std::vector<double> lr(xr.size()), li(xr.size()), re = xr, im = xi;
  d.apply(xr.data(), lr.data(), 0, 1, kSerial), d.apply(xi.data(), li.data(), 0, 1, kSerial);
  for (size_t i = 0; i < xr.size(); ++i) {
    if (d.lattice().fixed(d.lattice().place(i))) continue;
    re[i] -= a * lr[i] - b * li[i], im[i] -= a * li[i] + b * lr[i];
  }
  ASSERT_TRUE(solver.factor(Complex(1), Complex(a, b)));
  solver.solve(re.data(), im.data(), kSerial);
  double worst = 0;
  for (size_t i = 0; i < xr.size(); ++i) {
    worst = std::max({worst, std::abs(re[i] - xr[i]), std::abs(im[i] - xi[i])});
  }
  EXPECT_LT(worst, tolerance);
  // A real and a complex matrix exist at the same time, whichever came last.
  auto both = apply(d, 1, 0.3, xr);
  ASSERT_TRUE(solver.factor(1, 0.3));
  ASSERT_TRUE(solver.factor(Complex(1), Complex(a, b)));
  solver.solve(both.data(), kSerial);
  worst = 0;
  for (size_t i = 0; i < xr.size(); ++i) worst = std::max(worst, std::abs(both[i] - xr[i]));
  EXPECT_LT(worst, tolerance);
}

TEST(SpectralSolver, SolvesWithComplexSteps) {
  for (const ShiftedCase& c : kConstant) {
    const Diffusion d(box(c.cells, c.sides), 2, {0.7, {}, {}});
    SpectralSolver solver(d);
    expect_complex(d, solver, 1e-11);
  }
}

const ShiftedCase kVarying[] = {{{33}, {{kD, kR}}},
                                {{32, 32}, {{kD, kD}, {kD, kD}}},
                                {{37, 22}, {{kN, kD}, {kR, kN}}},
                                {{24, 40}, {{kP, kP}, {kD, kR}}},
                                {{64, 5}, {{kD, kN}, {kN, kD}}},
                                {{12, 10, 9}, {{kD, kD}, {kR, kN}, {kN, kD}}},
                                {{8, 9, 10}, {{kP, kP}, {kN, kN}, {kD, kD}}}};

TEST(MultigridSolver, SolvesWhatTheOperatorSays) {
  for (const ShiftedCase& c : kVarying) {
    const Diffusion d = varying(box(c.cells, c.sides));
    MultigridSolver solver(d.lattice(), varying);
    const auto x = shifted_noise(d.lattice().nodes(), 5);
    for (const double step : {1e-4, 0.3, 1e3}) {
      auto b = apply(d, 1, step, x);
      ASSERT_TRUE(solver.factor(1, step));
      solver.solve(b.data(), kSerial);
      double worst = 0;
      for (size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(x[i] - b[i]));
      // The residual's mean falls to 1e-10; the error has at most the condition times that, its largest
      // element at most root n times the mean.
      const double condition = 1 + step * d.spectral_radius(), root = std::sqrt(double(x.size()));
      EXPECT_LT(worst, 1e-10 * condition * root) << c.cells[0] << " step " << step;
      EXPECT_LT(worst, 1e-6);
    }
    expect_complex(d, solver, 1e-8);
  }
}

// Mean factor per cycle of the residual's norm over the last five of ten cycles, with b = 0 and x noise:
// Poisson's equation itself, the hardest shift.
double contraction(const Lattice& l, const std::function<Diffusion(const Lattice&)>& discretise) {
  Multigrid<double> m(l, discretise);
  EXPECT_TRUE(m.factor(0, 1));
  const size_t n = l.nodes();
  Multigrid<double>::Vector b(n), x(n), r(n);
  const auto start = shifted_noise(n, 9);
  for (size_t i = 0; i < n; ++i) x[i] = l.fixed(l.place(i)) ? 0 : start[i];
  double before = 0;
  for (int k = 0; k < 10; ++k) {
    if (k == 5) m.residual(b.data(), x.data(), r.data(), kSerial), before = m.norm(r.data(), kSerial);
    m.cycle(b.data(), x.data(), kSerial);
  }
  m.residual(b.data(), x.data(), r.data(), kSerial);
  return std::pow(m.norm(r.data(), kSerial) / before, 0.2);
}

TEST(Multigrid, ACycleContractsByAFifth) {
  const ShiftedCase cases[] = {{{128}, {{kD, kD}}},
                               {{64, 64}, {{kD, kD}, {kD, kD}}},
                               {{128, 128}, {{kD, kD}, {kD, kD}}},
                               {{96, 70}, {{kD, kN}, {kR, kN}}},
                               {{100, 64}, {{kD, kN}, {kP, kP}}},
                               {{65, 33}, {{kD, kD}, {kN, kN}}},
                               {{64, 8}, {{kD, kD}, {kD, kD}}},
                               {{32, 32, 32}, {{kD, kD}, {kD, kD}, {kD, kD}}},
                               {{24, 20, 31}, {{kD, kN}, {kN, kN}, {kD, kR}}}};
  for (const ShiftedCase& c : cases) {
    const Lattice l = box(c.cells, c.sides);
    const double factor = contraction(l, varying);
    std::printf("cells %zu%s%s: %.3f a cycle\n", c.cells[0],
                c.cells.size() > 1 ? (" x " + std::to_string(c.cells[1])).c_str() : "",
                c.cells.size() > 2 ? (" x " + std::to_string(c.cells[2])).c_str() : "", factor);
    // Three axes that are halved with a remainder interpolate slightly worse.
    EXPECT_LE(factor, c.cells.back() == 31 ? 0.25 : 0.2) << c.cells[0];
  }
  // Control: a coarse equation whose coefficient is wrong by a factor of two.
  const Lattice l = box({64, 64}, {{kD, kD}, {kD, kD}});
  const double wrong = contraction(l, [&](const Lattice& on) {
    Diffusion d = varying(on);
    if (!(on == l)) {
      for (auto& f : d.coefficient().faces) {
        for (double& v : f) v *= 2;
      }
    }
    return d;
  });
  EXPECT_GT(wrong, 0.3);
}

TEST(Multigrid, ManyThreadsGiveTheSameBits) {
  const Diffusion d = varying(box({300, 200}, {{kD, kN}, {kR, kN}}));
  const auto b = shifted_noise(d.lattice().nodes(), 4);
  std::vector<double> first;
  for (const int threads : {1, 2, 8}) {
    const ThreadArena arena(threads);
    MultigridSolver solver(d.lattice(), varying);
    solver.factor(1, 0.01);
    auto x = b;
    solver.solve(x.data(), arena);
    if (first.empty()) first = x;
    EXPECT_EQ(x, first) << threads;
  }
}

}  // namespace
}  // namespace truestep::lattice
