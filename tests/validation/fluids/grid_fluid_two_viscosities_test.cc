// Layers of two fluids of different viscosity in a channel: stress and velocity are continuous across their
// border, which makes Couette's profile two straight lines and Poiseuille's two parabolas.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/fluids/grid_flow.h"

namespace truestep::test {
namespace {

using namespace grid_fluid;

constexpr double kRatio = 2, kHeavier = 5, kLid = 1, kForce = 8;

// u(y) of two layers with a border at `border` in a channel of 1 m, densities 1 and kHeavier, kinematic
// viscosities 1 and kRatio: m u'' = -density force, by what is continuous.
double layered(double y, double border, double lid, double force) {
  const double low = 1, high = kHeavier * kRatio;  // Pa s
  const double b1 = force / (2 * low), b2 = kHeavier * force / (2 * high);
  // u1 = s1 y - b1 y^2 below, u2 = lid + s2 (1 - y) - b2 (1 - y)^2 above; stresses alike at the border.
  const double h = border, k = 1 - border;
  // low (s1 - 2 b1 h) = high (-s2 + 2 b2 k);  s1 h - b1 h^2 = lid + s2 k - b2 k^2
  const double s2 =
      (h * (2 * b1 * h + high / low * 2 * b2 * k) - b1 * h * h - lid + b2 * k * k) / (k + high / low * h);
  const double s1 = 2 * b1 * h + high / low * (2 * b2 * k - s2);
  return y < border ? s1 * y - b1 * y * y : lid + s2 * (1 - y) - b2 * (1 - y) * (1 - y);
}

// Largest distances from the profile beside the largest velocity; `judged` is the border it has there.
struct Off {
  double pure = 0, mixed = 0;  ///< of cells of one fluid, of the row that the border crosses
};
Off off(int64_t cells, double border, double lid, double force, double judged) {
  GridFluidDef d;
  d.cells = {4, cells};
  d.size = {4.0 / double(cells), 1};
  d.viscosity = 1;
  d.sides.x_min = FlowSideDef{SideKind::periodic, {}};
  d.sides.y_max = FlowSideDef{SideKind::wall, {std::to_string(lid), "0"}};
  d.force = {std::to_string(force), "0"};
  d.second_fluid = SecondFluidDef{"y - " + std::to_string(border), kHeavier, kRatio};
  // Stands from the start but for what the grid changes; the slowest mode loses exp(-pi^2 t).
  GridFlow run(d, 0.02);
  run.steps(75);
  const mac::MacGrid& g = run.model().grid;
  Off most;
  double largest = 0;
  const auto share = run.state.f64(static_cast<State::Column>(g.dimensions + 2));
  for (size_t j = 0; j < g.cells[1]; ++j) {
    const double exact = layered(g.coordinate(0, 1, double(j)), judged, lid, force);
    const double apart = std::abs(run.state.f64(0)[g.at(1, j, 0)] - exact);
    const double filled = share[g.at(1, j, 0)];
    double& of = filled > 1e-6 && filled < 1 - 1e-6 ? most.mixed : most.pure;
    of = std::max(of, apart), largest = std::max(largest, std::abs(exact));
  }
  return {most.pure / largest, most.mixed / largest};
}

TEST(GridFluidTwoViscosities, LayersSlideOverEachOtherUnderOneStress) {
  // Border on faces, and within a row of cells, whose fluidity is the mean: what those beyond it have is
  // exact, the row itself lies on neither line, off by up to a quarter of a cell times the jump of the
  // slopes, 1.6 / s.
  const Off on = off(8, 0.5, kLid, 0, 0.5), within = off(8, 0.52, kLid, 0, 0.52);
  std::printf("  Couette: %.1e on faces, %.1e within cells, there %.1e\n", on.pure, within.pure,
              within.mixed);
  // exp(-15) of the start, and the tolerance of the pressure.
  EXPECT_LT(on.pure, 1e-5);
  EXPECT_LT(within.pure, 1e-5);
  EXPECT_LT(within.mixed, 1.6 / 8 / 4);
  const Off a = off(8, 0.5, 0, kForce, 0.5), b = off(16, 0.5, 0, kForce, 0.5);
  std::printf("  Poiseuille: %.1e, %.1e with 8, 16 cells\n", a.pure, b.pure);
  EXPECT_LT(b.pure, 0.35 * a.pure) << "of second order, a quarter";
  EXPECT_LT(b.pure, 0.01);
  // Control: the profile of another border.
  EXPECT_GT(off(8, 0.5, kLid, 0, 0.55).pure, 0.01);
}

}  // namespace
}  // namespace truestep::test
