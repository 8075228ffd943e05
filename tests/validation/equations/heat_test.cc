// Heat conduction against exact solutions: separated modes, manufactured solutions with sides of every kind,
// the heat kernel; observed order in space and time; and conservation in an insulated box.
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "engine/base/errors.h"
#include "engine/integrators/table/integrators.h"
#include "engine/math/trig.h"
#include "tests/support/fluids/field_run.h"

namespace truestep::test {
namespace {

using heat::HeatDef;
using lattice::LatticeDef;
using lattice::SideKind;

// Slopes of log error over halvings of the spacing. The next term of the error, smaller by h^2, leaves some
// hundredths at these spacings; corners between sides of different kinds converge later.
double observed_order(const std::function<double(int cells)>& error, int first) {
  const double a = error(first), b = error(2 * first), c = error(4 * first);
  std::printf("  errors %.3e %.3e %.3e, order %.2f %.2f\n", a, b, c, std::log2(a / b), std::log2(b / c));
  return std::log2(b / c);
}

struct Mode {
  const char *name, *text;  ///< in s, on [0, 1]
  SideKind low, high;
  double wave;  ///< number
};
const Mode kModes[] = {
    {"fixed", "sin(pi*s)", SideKind::dirichlet, SideKind::dirichlet, std::numbers::pi},
    {"insulated", "cos(pi*s)", SideKind::neumann, SideKind::neumann, std::numbers::pi},
    {"mixed", "sin(1.5*pi*s)", SideKind::dirichlet, SideKind::neumann, 1.5 * std::numbers::pi},
    {"mixed the other way", "cos(1.5*pi*s)", SideKind::neumann, SideKind::dirichlet, 1.5 * std::numbers::pi},
    {"periodic", "sin(2*pi*s)", SideKind::periodic, SideKind::periodic, 2 * std::numbers::pi}};

double mode_value(const Mode& m, double s) {
  return m.text[0] == 's' ? std::sin(m.wave * s) : std::cos(m.wave * s);
}
std::string mode_text(const Mode& m, char variable) {
  std::string text = m.text;
  text[text.rfind('s', text.size() - 2)] = variable;
  return text;
}

TEST(Heat, SeparatedModesDecayAtTheirRate) {
  // Pairs of modes along x and y, a third along z; 0.02 s halves the slowest.
  for (const auto order : {LatticeDef::Order::second, LatticeDef::Order::fourth}) {
    for (size_t k = 0; k < std::size(kModes); ++k) {
      for (size_t d = 1; d <= 3; ++d) {
        const Mode* m[] = {&kModes[k], &kModes[(k + 1) % std::size(kModes)],
                           &kModes[(k + 2) % std::size(kModes)]};
        const auto error = [&](int cells) {
          HeatDef def;
          def.cells.assign(d, cells);
          def.order = order;
          def.diffusivity = "0.5";
          def.initial = mode_text(*m[0], 'x');
          double rate = m[0]->wave * m[0]->wave;
          std::optional<lattice::SideDef>* const sides[] = {&def.sides.x_min, &def.sides.x_max,
                                                            &def.sides.y_min, &def.sides.y_max,
                                                            &def.sides.z_min, &def.sides.z_max};
          for (size_t a = 0; a < d; ++a) {
            *sides[2 * a] = side(m[a]->low), *sides[2 * a + 1] = side(m[a]->high);
            if (a > 0) {
              def.initial += std::string("*") + mode_text(*m[a], a == 1 ? 'y' : 'z');
              rate += m[a]->wave * m[a]->wave;
            }
          }
          def.integrator = "sdirk4";
          def.tolerance = 1e-10;
          FieldRun run(def, 0.02);
          run.steps(1);
          const double decay = std::exp(-0.5 * rate * 0.02);
          return run.error([&](double x, double y, double z) {
            const double at[] = {x, y, z};
            double u = decay;
            for (size_t a = 0; a < d; ++a) u *= mode_value(*m[a], at[a]);
            return u;
          });
        };
        const int promised = order == LatticeDef::Order::second ? 2 : 4;
        std::printf("%s, %zu-D, order %d\n", m[0]->name, d, promised);
        EXPECT_NEAR(observed_order(error, d == 3 ? 6 : 10), promised, 0.15);
      }
    }
  }
}

// u = e^-t sin(x + 2 y + 0.3) + x y on the unit square with a diffusivity of 0.5.
struct Manufactured {
  static double u(double t, double x, double y) { return std::exp(-t) * std::sin(x + 2 * y + 0.3) + x * y; }
  static HeatDef def(int cells, LatticeDef::Order order) {
    HeatDef d;
    d.cells = {cells, cells};
    d.order = order;
    d.diffusivity = "0.5";
    d.initial = "sin(x + 2*y + 0.3) + x*y";
    // u_t - 0.5 (u_xx + u_yy)
    d.source = "1.5*exp(-t)*sin(x + 2*y + 0.3)";
    d.sides.x_min = side(SideKind::dirichlet, "exp(-t)*sin(x + 2*y + 0.3) + x*y");
    d.sides.y_max = d.sides.x_min;
    d.sides.x_max = side(SideKind::neumann, "exp(-t)*cos(x + 2*y + 0.3) + y");
    d.sides.y_min = side(SideKind::neumann, "-(2*exp(-t)*cos(x + 2*y + 0.3) + x)");
    d.integrator = "sdirk4";
    d.tolerance = 1e-10;
    return d;
  }
};

TEST(Heat, ManufacturedSolutionWithGivenValuesAndSlopes) {
  for (const auto order : {LatticeDef::Order::second, LatticeDef::Order::fourth}) {
    const auto error = [&](int cells) {
      FieldRun run(Manufactured::def(cells, order), 0.25);
      run.steps(2);
      return run.error([](double x, double y, double) { return Manufactured::u(0.5, x, y); });
    };
    EXPECT_NEAR(observed_order(error, 8), order == LatticeDef::Order::second ? 2 : 4, 0.25);
  }
  // Control: the slope with the wrong sign.
  HeatDef wrong = Manufactured::def(32, LatticeDef::Order::second);
  wrong.sides.x_max->value = "-(" + wrong.sides.x_max->value + ")";
  FieldRun run(wrong, 0.25);
  run.steps(2);
  EXPECT_GT(run.error([](double x, double y, double) { return Manufactured::u(0.5, x, y); }), 0.1);
}

TEST(Heat, ManufacturedSolutionWithVariableCoefficientAndRobinSides) {
  // u = e^-t cos(x - y), a = 1 + x y / 2: div(a grad u) = -2 a u + (u_x a_x + u_y a_y) with
  // u_x = -e^-t sin(x - y) = -u_y, so that the last term is -(y - x)/2 e^-t sin(x - y).
  const auto def = [](int cells) {
    HeatDef d;
    d.cells = {cells, cells};
    d.diffusivity = "1 + x*y/2";
    d.initial = "cos(x - y)";
    d.source = "exp(-t)*((1 + x*y)*cos(x - y) + (y - x)/2*sin(x - y))";
    // du/dn = 2 (g - u): g = u + du/dn / 2.
    d.sides.x_min = side(SideKind::robin, "exp(-t)*(cos(x - y) + sin(x - y)/2)", 2);
    d.sides.x_max = side(SideKind::robin, "exp(-t)*(cos(x - y) - sin(x - y)/2)", 2);
    d.sides.y_min = side(SideKind::dirichlet, "exp(-t)*cos(x - y)");
    d.sides.y_max = side(SideKind::neumann, "exp(-t)*sin(x - y)");
    d.integrator = "sdirk4";
    d.tolerance = 1e-9;
    return d;
  };
  const auto exact = [](double x, double y, double) { return std::exp(-0.5) * std::cos(x - y); };
  const auto error = [&](int cells) {
    FieldRun run(def(cells), 0.25);
    run.steps(2);
    return run.error(exact);
  };
  EXPECT_NEAR(observed_order(error, 8), 2, 0.15);
  HeatDef wrong = def(32);
  wrong.sides.x_min->transfer = 2.5;
  FieldRun run(wrong, 0.25);
  run.steps(2);
  EXPECT_GT(run.error(exact), 5e-3) << "control: another transfer";
}

TEST(Heat, MethodsHaveTheirOrderInTime) {
  // One mode on a lattice: y' = -lambda y exactly, lambda = 4 a / h^2 sin^2(pi h / 2).
  const double h = 1.0 / 16, s = std::sin(0.5 * std::numbers::pi * h), lambda = 4 / (h * h) * s * s,
               end = 0.25;
  const auto error = [&](const char* method, uint64_t n) {
    HeatDef d;
    d.cells = {16};
    d.all = side(SideKind::dirichlet);
    d.initial = "sin(pi*x)";
    d.integrator = method;
    d.tolerance = 1e300;
    FieldRun run(d, end / double(n));
    run.steps(n);
    return run.error(
        [&](double x, double, double) { return std::exp(-lambda * end) * std::sin(std::numbers::pi * x); });
  };
  struct Row {
    const char* method;
    int order;
    uint64_t first;
  };
  for (const Row& r :
       {Row{"euler", 1, 1024}, Row{"heun", 2, 256}, Row{"rk4", 4, 128}, Row{"trapezoid", 2, 32},
        Row{"bdf2", 2, 64}, Row{"tr_bdf2", 2, 32}, Row{"sdirk4", 4, 8}, Row{"rkc2", 2, 64}}) {
    const double a = error(r.method, r.first), b = error(r.method, 2 * r.first);
    std::printf("%-10s order %d observed %.3f (error %.2e)\n", r.method, r.order, std::log2(a / b), b);
    // One halving without extrapolation.
    EXPECT_NEAR(std::log2(a / b), r.order, 0.2) << r.method;
  }
}

TEST(Heat, TolerancesAreKept) {
  const double h = 1.0 / 64, s = std::sin(0.5 * std::numbers::pi * h), lambda = 4 / (h * h) * s * s;
  for (const char* method : {"rkc2", "sdirk4", "radau5", "rodas5p", "cvode_bdf", "dopri5"}) {
    const double order = std::min(find_integrator(method)->order, 5);
    double first = 0, last = 0;
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
      HeatDef d;
      d.cells = {64};
      d.all = side(SideKind::dirichlet);
      d.initial = "sin(pi*x)";
      d.integrator = method;
      d.tolerance = tolerance;
      FieldRun run(d, 0.1);
      run.steps(2);
      last = run.error(
          [&](double x, double, double) { return std::exp(-lambda * 0.2) * std::sin(std::numbers::pi * x); });
      if (first == 0) first = last;
      std::printf("%-10s tolerance %.0e error %.2e, %g evaluations\n", method, tolerance, last,
                  run.observed("integrator.rates"));
      // Steps h with an error of h^(p + 1) = tolerance each accumulate to tolerance / h; CVODE's order
      // varies.
      EXPECT_LT(last, 10 * std::max(tolerance, 0.1 * std::pow(tolerance, order / (order + 1)))) << method;
    }
    EXPECT_LT(last, first / 30) << method;
  }
}

TEST(Heat, TheDiffusivityMayMoveInTime) {
  // a = 1 + sin(20 t) / 2 has the integral t + (1 - cos(20 t)) / 40: one mode on its lattice, exactly.
  const double h = 1.0 / 12, s = std::sin(0.5 * std::numbers::pi * h), lambda = 8 / (h * h) * s * s,
               end = 0.1;
  const double decay = std::exp(-lambda * (end + (1 - std::cos(20 * end)) / 40));
  const auto error = [&](const char* method, const char* diffusivity) {
    HeatDef d;
    d.cells = {12, 12};
    d.all = side(SideKind::dirichlet);
    d.diffusivity = diffusivity;
    d.initial = "sin(pi*x)*sin(pi*y)";
    d.integrator = method;
    d.tolerance = 1e-7;
    FieldRun run(d, 0.05);
    run.steps(2);
    std::printf("%-10s %g evaluations, %g rejected\n", method, run.observed("integrator.rates"),
                run.observed("integrator.rejected"));
    return run.error([&](double x, double y, double) {
      return decay * std::sin(std::numbers::pi * x) * std::sin(std::numbers::pi * y);
    });
  };
  for (const char* method : {"rkc2", "dop853", "tr_bdf2", "sdirk4", "rodas5p", "radau5", "cvode_bdf"}) {
    // Of second order with errors of h^3: tolerance^(2/3) times a few.
    EXPECT_LT(error(method, "1 + sin(20*t)/2"), 5e-5) << method;
  }
  EXPECT_GT(error("sdirk4", "1"), 1e-2) << "control";
}

TEST(Heat, KernelSpreads) {
  // Gaussian of width sqrt(2 a t) from t0 = 0.01 to 0.04 on [-2, 2], where its tail is below e^-25.
  const auto kernel = [](double t, double x) {
    return std::exp(-x * x / (4 * t)) / std::sqrt(4 * std::numbers::pi * t);
  };
  HeatDef d;
  d.cells = {200};
  d.size = {4};
  d.origin = Vec3{-2, 0, 0};
  d.order = LatticeDef::Order::fourth;
  d.initial = "exp(-x^2/0.04)/sqrt(0.04*pi)";
  d.tolerance = 1e-8;
  FieldRun run(d, 1e-3);
  EXPECT_EQ(static_cast<const heat::Heat&>(*run.system).method().name, "rkc2");
  run.steps(30);
  const auto exact = [&](double x, double, double) { return kernel(0.04, x); };
  // h^4 / 90 u^(6) t: 0.02^4 / 90 * 15 * 8 / 0.02^3 ... about 2e-5 of 2.8 at the start, 1e-6 at the end.
  EXPECT_LT(run.error(exact), 2e-5);
  EXPECT_GT(run.error([&](double x, double, double) { return kernel(0.0401, x); }), 1e-3) << "control";
}

TEST(Heat, AnInsulatedBoxKeepsItsHeat) {
  for (const char* method : {"euler", "rk4", "rkc2", "trapezoid", "sdirk4", "radau5"}) {
    for (const char* diffusivity : {"0.5", "0.5 + 0.4*sin(6*x)*y"}) {
      HeatDef d;
      d.cells = {20, 14};
      d.diffusivity = diffusivity;
      d.initial = "exp(-20*((x - 0.3)^2 + (y - 0.6)^2))";
      d.integrator = method;
      FieldRun run(d, 2e-4);
      const double before = run.observed("energy.thermal");
      run.steps(50);
      // Multigrid leaves 1e-10 of the residual; all others only round.
      EXPECT_NEAR(run.observed("energy.thermal") / before, 1, 1e-11) << method;
      EXPECT_LT(run.observed("value.max"), 0.99);
    }
  }
  // Control: a cold side.
  HeatDef d;
  d.cells = {20, 14};
  d.initial = "1";
  d.sides.x_min = side(SideKind::dirichlet);
  FieldRun run(d, 2e-4);
  run.steps(50);
  EXPECT_LT(run.observed("energy.thermal"), 0.9);
}

TEST(Heat, AnImpulseAddsItsHeat) {
  HeatDef d;
  d.cells = {8, 8};
  d.heat_capacity = 4;
  FieldRun run(d, 1e-3);
  Command c;
  c.kind = CommandKind::impulse, c.index = 40, c.vector = {3, 0, 0};
  run.system->apply(run.state, c);
  EXPECT_NEAR(run.observed("energy.thermal"), 3, 1e-14);
  c.at = Vec3{0.03, 0.71, 0};
  run.system->apply(run.state, c);
  EXPECT_NEAR(run.observed("energy.thermal"), 6, 1e-13);
  c.at = Vec3{1.03, 0.71, 0};
  EXPECT_THROW(run.system->apply(run.state, c), Error);
}

TEST(Heat, ExplicitMethodsHoldTheStepOfTheory) {
  for (const size_t dimensions : {1, 2, 3}) {
    HeatDef d;
    d.cells.assign(dimensions, 8);
    d.diffusivity = "0.5";
    d.all = side(SideKind::dirichlet);
    // The shortest wave of the lattice together with the longest.
    d.initial = "sin(pi*x) + 1e-3*sin(7*pi*x)";
    if (dimensions > 1) d.initial = "(" + d.initial + ")*(sin(pi*y) + 1e-3*sin(7*pi*y))";
    if (dimensions > 2) d.initial += "*(sin(pi*z) + 1e-3*sin(7*pi*z))";
    d.integrator = "euler";
    const double limit = 1.0 / 64 / (2 * double(dimensions) * 0.5);
    FieldRun below(d, 0.999 * limit);
    EXPECT_NEAR(*below.system->limit(Limit::stable_dt, below.state, 0), limit, 1e-12);
    below.steps(2000);
    EXPECT_LT(below.observed("value.max"), 1);
    // The shortest wave, cos(7 pi / 8) short of the bound: 1 - dt lambda < -1 from 1.04 times the limit on.
    FieldRun above(d, 1.06 * limit);
    above.steps(2000);
    EXPECT_GT(above.observed("value.max"), 1e3);
  }
}

TEST(Heat, PlansAndRefusals) {
  HeatDef d;
  d.cells = {64, 64};
  const auto method = [&](double dt) {
    FieldRun run(d, dt);
    return std::string(static_cast<const heat::Heat&>(*run.system).method().name);
  };
  EXPECT_EQ(method(1e-5), "rk4");
  EXPECT_EQ(method(1e-2), "rkc2");
  EXPECT_EQ(method(10), "sdirk4");
  d.integrator = "leapfrog";
  try {
    method(1e-5);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.issues().at(0).pointer, "/integrator");
    EXPECT_NE(e.issues().at(0).allowed.find("rkc2"), std::string::npos);
  }
  d.integrator = "";
  d.diffusivity = "1 + q";
  d.source = "sin(";
  try {
    method(1e-5);
    ADD_FAILURE();
  } catch (const Error& e) {
    ASSERT_EQ(e.issues().size(), 2u);
    EXPECT_EQ(e.issues()[0].pointer, "/diffusivity");
    EXPECT_EQ(e.issues()[1].pointer, "/source");
  }
}

}  // namespace
}  // namespace truestep::test
