// Stencils and the operator div(c grad) on lattices: exact for polynomials, self-adjoint, equal to its own
// matrix, within its own bounds.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/kernels/stencil.h"
#include "engine/lattice/diffusion.h"

namespace truestep::lattice {
namespace {

const ThreadArena kSerial(1);
constexpr auto D = SideKind::dirichlet, N = SideKind::neumann, R = SideKind::robin, P = SideKind::periodic;

std::vector<double> noise(size_t n, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> between(-1, 1);
  std::vector<double> v(n);
  for (double& x : v) x = between(generator);
  return v;
}

TEST(Stencil, SecondDerivativesAreExactOnPolynomials) {
  // Order 2 for cubics, order 4 for quintics; one degree more has the error 2 h^2 and 8 h^4 for x^4 and x^6.
  const double h = 0.25;
  std::vector<double> u(9), out(9);
  for (const int degree : {3, 4, 5, 6}) {
    for (size_t i = 0; i < u.size(); ++i) u[i] = std::pow(0.1 + h * double(i), degree);
    const double x = 0.1 + 4 * h, exact = degree * (degree - 1) * std::pow(x, degree - 2);
    const auto derivative = [&]<int kReach>(const stencil::SecondDerivative& d) {
      const stencil::RowWeights w{d.centre / (h * h), d.near / (h * h), d.far / (h * h), {}, {}};
      stencil::combine_row<kReach, 0>(u.data(), w, out.data(), 4, 5);
      return std::abs(out[4] - exact);
    };
    const double second = derivative.operator()<1>(stencil::kOrder2),
                 fourth = derivative.operator()<2>(stencil::kOrder4);
    if (degree <= 3) {
      EXPECT_LT(second, 1e-12);
    } else {
      EXPECT_GT(second, h * h);
    }
    if (degree <= 5) {
      EXPECT_LT(fourth, 1e-11);
    } else {
      EXPECT_GT(fourth, h * h * h * h);
    }
  }
}

struct Case {
  std::vector<size_t> cells;
  std::vector<std::array<SideKind, 2>> sides;
  int order;
  bool variable;
};
const Case kCases[] = {{{14}, {{D, N}}, 4, false},
                       {{14}, {{D, R}}, 2, true},
                       {{9, 12}, {{D, D}, {P, P}}, 4, false},
                       {{9, 12}, {{N, R}, {D, N}}, 2, false},
                       {{9, 12}, {{R, D}, {P, P}}, 2, true},
                       {{6, 7, 8}, {{D, N}, {N, N}, {P, P}}, 4, false},
                       {{6, 7, 5}, {{D, N}, {R, N}, {P, P}}, 2, true}};

Diffusion make(const Case& c) {
  Lattice l;
  l.dimensions = c.cells.size();
  for (size_t a = 0; a < l.dimensions; ++a) {
    l.axes[a] = {.cells = c.cells[a], .spacing = 1.0 / double(c.cells[a])};
    for (size_t e = 0; e < 2; ++e) l.axes[a].sides[e] = {c.sides[a][e], c.sides[a][e] == R ? 2.0 : 0.0};
  }
  Coefficient k{0.7, {}, {}};
  if (c.variable) {
    k.nodes = noise(l.nodes(), 1);
    for (double& v : k.nodes) v += 1.5;
    for (size_t a = 0; a < l.dimensions; ++a) {
      k.faces[a] = noise(l.nodes(), unsigned(a + 2));
      for (double& v : k.faces[a]) v += 1.5;
    }
  }
  return Diffusion(l, c.order, k);
}

/// u L v weighted by the nodes' volumes, u and v 0 where values are given.
double form(const Diffusion& d, const std::vector<double>& u, const std::vector<double>& v) {
  std::vector<double> lv(v.size());
  d.apply(v.data(), lv.data(), 0, 1, kSerial);
  double sum = 0;
  for (size_t i = 0; i < u.size(); ++i) sum += d.lattice().volume(d.lattice().place(i)) * u[i] * lv[i];
  return sum;
}

TEST(Diffusion, IsSelfAdjointNegativeAndItsEnergyIsItsForm) {
  std::vector<double> sums;
  for (const Case& c : kCases) {
    const Diffusion d = make(c);
    auto u = noise(d.lattice().nodes(), 11), v = noise(d.lattice().nodes(), 12);
    for (size_t i = 0; i < u.size(); ++i) {
      if (d.lattice().fixed(d.lattice().place(i))) u[i] = v[i] = 0;
    }
    const double uv = form(d, u, v), vu = form(d, v, u), uu = form(d, u, u);
    EXPECT_NEAR(uv, vu, 1e-11 * std::abs(uu));
    EXPECT_LT(uu, 0);
    EXPECT_NEAR(d.potential(u.data(), sums), -0.5 * uu, 1e-12 * std::abs(uu))
        << c.cells[0] << " order " << c.order;
  }
}

TEST(Diffusion, IsItsOwnMatrixInPlaceAndBounded) {
  for (const Case& c : kCases) {
    const Diffusion d = make(c);
    const size_t n = d.lattice().nodes();
    auto u = noise(n, 13);
    std::vector<double> direct(n), product(n), waiting;
    d.apply(u.data(), direct.data(), 0, 1, kSerial);
    const auto m = d.matrix();
    for (size_t j = 0; j < n; ++j) {
      for (auto k = size_t(m.column_start[j]); k < size_t(m.column_start[j + 1]); ++k) {
        product[size_t(m.rows[k])] += m.values[k] * u[j];
      }
    }
    const double radius = d.spectral_radius();
    for (size_t i = 0; i < n; ++i) EXPECT_NEAR(direct[i], product[i], 1e-13 * radius);
    auto stepped = u;
    d.step_in_place(stepped.data(), 1e-4, waiting);
    d.apply(u.data(), direct.data(), 1, 1e-4, kSerial);
    EXPECT_EQ(stepped, direct) << c.cells[0];
    auto x = noise(n, 7), v = noise(n, 8), one = x, rate = v;
    d.leapfrog_in_place(x.data(), v.data(), 1e-3, waiting);
    const auto drift = [&] {
      for (size_t i = 0; i < n; ++i) one[i] = std::fma(0.5e-3, rate[i], one[i]);
    };
    drift();
    d.apply(one.data(), direct.data(), 0, 1, kSerial);
    for (size_t i = 0; i < n; ++i) rate[i] = std::fma(1e-3, direct[i], rate[i]);
    drift();
    EXPECT_EQ(x, one) << c.cells[0];
    EXPECT_EQ(v, rate) << c.cells[0];
    // Power iteration converges from below, and closely where the coefficient is constant.
    double largest = 0;
    for (int k = 0; k < 400; ++k) {
      d.apply(u.data(), product.data(), 0, 1, kSerial);
      largest = 0;
      for (const double p : product) largest = std::max(largest, std::abs(p));
      for (size_t i = 0; i < n; ++i) u[i] = product[i] / largest;
    }
    EXPECT_LE(largest, radius * (1 + 1e-12));
    EXPECT_GT(largest, (c.variable ? 0.5 : 0.9) * radius);
  }
}

}  // namespace
}  // namespace truestep::lattice
