// Waves against exact solutions: d'Alembert's on a string, standing waves in one to three dimensions and
// orders 2 and 4, a manufactured solution; the energy conserved by symplectic methods and its monitoring.
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "engine/base/errors.h"
#include "tests/support/fluids/field_run.h"

namespace truestep::test {
namespace {

using lattice::LatticeDef;
using lattice::SideKind;
using wave::WaveDef;

double observed_wave_order(const std::function<double(int cells)>& error, int first) {
  const double a = error(first), b = error(2 * first), c = error(4 * first);
  std::printf("  errors %.3e %.3e %.3e, order %.2f %.2f\n", a, b, c, std::log2(a / b), std::log2(b / c));
  return std::log2(b / c);
}

WaveDef string(int cells) {
  WaveDef d;
  d.cells = {cells};
  return d;
}

TEST(Wave, StandingWavesTurnAtTheirFrequency) {
  for (const auto order : {LatticeDef::Order::second, LatticeDef::Order::fourth}) {
    for (size_t dimensions = 1; dimensions <= 3; ++dimensions) {
      // sin along x, cos between insulated sides along y, a periodic wave along z.
      const auto error = [&](int cells) {
        WaveDef d;
        d.cells.assign(dimensions, cells);
        d.order = order;
        d.speed = "2";
        d.initial = "sin(pi*x)";
        double k2 = std::numbers::pi * std::numbers::pi;
        if (dimensions > 1) {
          d.initial += "*cos(pi*y)", k2 += std::numbers::pi * std::numbers::pi;
          d.sides.y_min = d.sides.y_max = side(SideKind::neumann);
        }
        if (dimensions > 2) {
          d.initial += "*sin(2*pi*z)", k2 += 4 * std::numbers::pi * std::numbers::pi;
          d.sides.z_min = side(SideKind::periodic);
        }
        d.integrator = "dop853";
        d.tolerance = 1e-9;
        FieldRun run(d, 0.1);
        run.steps(3);
        const double phase = std::cos(2 * std::sqrt(k2) * 0.3);
        return run.error([&](double x, double y, double z) {
          return phase * std::sin(std::numbers::pi * x) *
                 (dimensions > 1 ? std::cos(std::numbers::pi * y) : 1) *
                 (dimensions > 2 ? std::sin(2 * std::numbers::pi * z) : 1);
        });
      };
      const int promised = order == LatticeDef::Order::second ? 2 : 4;
      std::printf("%zu-D, order %d\n", dimensions, promised);
      EXPECT_NEAR(observed_wave_order(error, 8), promised, 0.15);
    }
  }
}

TEST(Wave, DAlembertsHalvesComeBack) {
  // A hump splits into two halves; each is inverted at a fixed end, so that after the time 1 / c the hump is
  // upside down at the mirrored place and after 2 / c back where it began.
  const auto hump = [](double x) { return std::exp(-400 * (x - 0.3) * (x - 0.3)); };
  const auto error = [&](int cells, uint64_t steps) {
    WaveDef d = string(cells);
    d.initial = "exp(-400*(x - 0.3)^2)";
    FieldRun run(d, 0.1 / double(steps));
    EXPECT_EQ(static_cast<const wave::Wave&>(*run.system).method().name, "leapfrog");
    run.steps(steps);
    return run.error([&](double x, double, double) { return 0.5 * (hump(x - 0.1) + hump(x + 0.1)); });
  };
  // A step of dx / c makes the leapfrog scheme exact on a string: rounding is all that is left. The hump at
  // the ends, e^-36, is not.
  WaveDef exact = string(200);
  exact.initial = "exp(-400*(x - 0.3)^2)";
  exact.integrator = "velocity_verlet";
  FieldRun run(exact, 1.0 / 200);
  run.steps(200);
  EXPECT_LT(run.error([&](double x, double, double) { return -hump(1 - x); }), 1e-11);
  // Otherwise order 2 in both.
  const double a = error(200, 24), b = error(400, 48), c = error(800, 96);
  std::printf("errors %.3e %.3e %.3e\n", a, b, c);
  EXPECT_NEAR(std::log2(b / c), 2, 0.15);
}

TEST(Wave, ManufacturedSolutionWithDampingAndMovingSides) {
  // u = cos(t) sin(x + 2 y): u_tt + k u_t - c^2 (u_xx + u_yy) = (-1 + 5 c^2) u - k sin(t) sin(x + 2 y).
  for (const auto order : {LatticeDef::Order::second, LatticeDef::Order::fourth}) {
    const auto error = [&](int cells, double damping) {
      WaveDef d;
      d.cells = {cells, cells};
      d.order = order;
      d.speed = "0.5";
      d.damping = damping;
      d.initial = "sin(x + 2*y)";
      d.source = "0.25*cos(t)*sin(x + 2*y) - 0.3*sin(t)*sin(x + 2*y)";
      d.sides.x_min = d.sides.y_max = side(SideKind::dirichlet, "cos(t)*sin(x + 2*y)");
      d.sides.x_max = side(SideKind::neumann, "cos(t)*cos(x + 2*y)");
      d.sides.y_min = side(SideKind::neumann, "-2*cos(t)*cos(x + 2*y)");
      d.integrator = "dop853";
      d.tolerance = 1e-10;
      FieldRun run(d, 0.5);
      run.steps(2);
      return run.error([](double x, double y, double) { return std::cos(1.0) * std::sin(x + 2 * y); });
    };
    EXPECT_NEAR(observed_wave_order([&](int n) { return error(n, 0.3); }, 8),
                order == LatticeDef::Order::second ? 2 : 4, 0.3);
    EXPECT_GT(error(32, 0.4), 3e-3) << "control: another damping";
  }
}

TEST(Wave, RefractsAtAVariableSpeed) {
  // u = cos(t) cos(x), c^2 = 1 + x: (c^2 u_x)_x = cos(t) (-sin x - (1 + x) cos x).
  const auto error = [&](int cells) {
    WaveDef d = string(cells);
    d.speed = "sqrt(1 + x)";
    d.initial = "cos(x)";
    d.source = "cos(t)*(sin(x) + x*cos(x))";
    d.sides.x_min = side(SideKind::neumann);
    // du/dn = 3 (g - u)
    d.sides.x_max = side(SideKind::robin, "cos(t)*(cos(x) - sin(x)/3)", 3);
    d.integrator = "dop853";
    d.tolerance = 1e-9;
    FieldRun run(d, 0.5);
    run.steps(2);
    return run.error([](double x, double, double) { return std::cos(1.0) * std::cos(x); });
  };
  EXPECT_NEAR(observed_wave_order(error, 8), 2, 0.15);
}

TEST(Wave, SymplecticMethodsKeepTheEnergy) {
  for (const auto order : {LatticeDef::Order::second, LatticeDef::Order::fourth}) {
    for (const char* method : {"leapfrog", "velocity_verlet", "yoshida4", "implicit_midpoint", "trapezoid"}) {
      WaveDef d;
      d.cells = {24, 24};
      d.order = order;
      d.sides.y_min = d.sides.y_max = side(SideKind::neumann);
      d.initial = "exp(-60*((x - 0.4)^2 + (y - 0.5)^2))";
      d.integrator = method;
      FieldRun run(d, 0.01);
      const double before = run.observed("energy.total");
      double lowest = before, highest = before;
      for (int k = 0; k < 200; ++k) {
        run.steps(10);
        const double e = run.observed("energy.total");
        lowest = std::min(lowest, e), highest = std::max(highest, e);
      }
      std::printf("%-18s energy %.6f swings from %+.1e to %+.1e\n", method, before, lowest / before - 1,
                  highest / before - 1);
      // (omega h)^2 / 12 at the hump's frequencies, some 20 / s: 0.4 %; none is lost in 2,000 steps. The
      // implicit midpoint rule conserves quadratic forms to the tolerance of its solves.
      const double most = method[0] == 'i' || method[0] == 't' ? 1e-8 : 0.01;
      EXPECT_LT(highest / before - 1, most) << method;
      EXPECT_GT(lowest / before - 1, -most) << method;
    }
  }
  // Control: a method that damps.
  WaveDef d;
  d.cells = {24, 24};
  d.initial = "exp(-60*((x - 0.4)^2 + (y - 0.5)^2))";
  d.integrator = "bdf2";
  FieldRun run(d, 0.01);
  const double before = run.observed("energy.total");
  run.steps(2000);
  EXPECT_LT(run.observed("energy.total"), 0.98 * before);
}

TEST(Wave, EnergyIsWhatTheSlopeHolds) {
  // sin(pi x) has c^2 pi^2 / 4; the lattice's own differences miss h^2 / 12 of that at order 2, h^4 / 90
  // at 4.
  for (const auto order : {LatticeDef::Order::second, LatticeDef::Order::fourth}) {
    WaveDef d = string(40);
    d.order = order;
    d.speed = "3";
    d.initial = "sin(pi*x)";
    FieldRun run(d, 1e-3);
    const double exact = 9 * std::numbers::pi * std::numbers::pi / 4, h = std::numbers::pi / 40;
    const double miss = order == LatticeDef::Order::second ? h * h / 12 : h * h * h * h / 90;
    EXPECT_NEAR(1 - run.observed("energy.potential") / exact, miss, 0.1 * miss);
  }
}

TEST(Wave, LeapfrogHoldsTheStepOfTheory) {
  for (const size_t dimensions : {1, 2, 3}) {
    WaveDef d;
    d.cells.assign(dimensions, 8);
    d.speed = "2";
    d.initial = "sin(pi*x) + 1e-3*sin(7*pi*x)";
    if (dimensions > 1) d.initial = "(" + d.initial + ")*(sin(pi*y) + 1e-3*sin(7*pi*y))";
    if (dimensions > 2) d.initial += "*(sin(pi*z) + 1e-3*sin(7*pi*z))";
    d.integrator = "leapfrog";
    const double limit = 0.125 / (2 * std::sqrt(double(dimensions)));
    FieldRun below(d, 0.999 * limit);
    EXPECT_NEAR(*below.system->limit(Limit::stable_dt, below.state, 0), limit, 1e-12);
    below.steps(2000);
    EXPECT_LT(below.observed("value.max"), 2);
    FieldRun above(d, 1.03 * limit);
    above.steps(500);
    EXPECT_GT(above.observed("value.max"), 1e3);
  }
  WaveDef d = string(100);
  FieldRun beyond(d, 0.02);
  EXPECT_EQ(static_cast<const wave::Wave&>(*beyond.system).method().name, "implicit_midpoint");
  d.integrator = "rkc2";
  EXPECT_NO_THROW(FieldRun(d, 0.02));
}

TEST(Wave, EveryImplicitRowTakesLongSteps) {
  // Slow standing wave in two dimensions through the lattice's own solvers, real, complex and of second
  // order.
  for (const char* method : {"implicit_midpoint", "trapezoid", "bdf2", "newmark", "generalized_alpha",
                             "tr_bdf2", "sdirk4", "radau5", "rodas5p"}) {
    for (const char* speed : {"1", "1 + 0.3*x"}) {
      const auto value = [&](double dt, uint64_t steps, const char* by) {
        WaveDef d;
        d.cells = {16, 12};
        d.speed = speed;
        d.damping = 0.2;
        d.initial = "sin(pi*x)*sin(pi*y)";
        d.integrator = by;
        d.tolerance = 1e-6;
        FieldRun run(d, dt);
        run.steps(steps);
        return run.values()[8 + 17 * 6];
      };
      EXPECT_NEAR(value(0.01, 50, method), value(0.01, 50, "dop853"), 3e-3) << method << " " << speed;
    }
  }
}

}  // namespace
}  // namespace truestep::test
