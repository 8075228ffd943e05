// Explicit methods on the initial value problems of the reference (ode.*, nbody.*): every row that supports a
// problem reaches the case's tolerance at its end with the solver tolerance named by the case or one finer;
// the same run with a coarse tolerance does not, which is the control.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "engine/base/errors.h"
#include "engine/core/equations/integrator.h"
#include "engine/integrators/advance.h"
#include "engine/integrators/table/integrators.h"
#include "tests/support/ode_problems.h"

namespace truestep::test {
namespace {

std::vector<double> run(std::string_view method, const RightHandSide& f, std::vector<double> y, double t_end,
                        Tolerance tolerance, uint64_t fixed_steps = 1) {
  Workspace workspace;
  Carry carry;
  Advance in{.f = f,
             .t = 0,
             .t_end = t_end,
             .y = y.data(),
             .workspace = workspace,
             .carry = carry,
             .tolerance = tolerance,
             .fixed_steps = fixed_steps};
  find_integrator(method)->advance(in);
  return y;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (size_t i = 0; i < b.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

// Every adaptive explicit row that is within `allowed` at tolerance `fine`, and not at `coarse`.
void check(const char* name, const RightHandSide& f, const std::vector<double>& start, double t_end,
           const std::vector<double>& end, double allowed, double fine, double coarse) {
  int served = 0;
  for (const Integrator& m : integrators()) {
    if (m.kind != Integrator::Kind::explicit_ || m.stepping != Integrator::Stepping::adaptive) continue;
    if (m.order < 5 || refusal(m, f)) continue;
    ++served;
    EXPECT_LT(largest_difference(run(m.name, f, start, t_end, {fine, fine}), end), allowed)
        << m.name << " on " << name;
    // ias15 is stricter than its tolerance: its coarsest runs are already this good.
    if (m.name == "ias15") continue;
    double control = HUGE_VAL;
    try {
      control = largest_difference(run(m.name, f, start, t_end, {coarse, coarse}), end);
    } catch (const Instability&) {
      // so coarse that bodies collide
    }
    EXPECT_GT(control, allowed) << m.name << " on " << name << ": the control passes";
  }
  EXPECT_GE(served, 4) << name;
}

template <class F>
Equations<F> equations(size_t n, F f) {
  return {n, f};
}
template <class A>
Motions<A> motions(size_t m, A a) {
  return {m, a};
}

TEST(OdeExplicit, DetestClassA) {
  const struct {
    const char* name;
    std::function<double(double, double)> f;
    double start, end;
  } cases[] = {
      {"A1", [](double, double y) { return -y; }, 1, 2.06115362243855783e-9},
      {"A2", [](double, double y) { return -0.5 * y * y * y; }, 1, 0.218217890235992381},
      {"A3", [](double t, double y) { return y * std::cos(t); }, 1, 2.49165027185041452},
      {"A4", [](double, double y) { return 0.25 * y * (1 - y / 20); }, 1, 17.7301664813148398},
      {"A5", [](double t, double y) { return (y - t) / (y + t); }, 4, -0.788782668896401424},
  };
  for (const auto& c : cases) {
    const auto f = equations(1, [&](double t, const double* y, double* d) { d[0] = c.f(t, y[0]); });
    for (const char* method : {"rkf45", "dopri5", "tsit5", "dop853"}) {
      // Relative 1e-7 at the end; A1 decays by nine orders of magnitude, so that only a relative tolerance
      // makes sense.
      const double allowed = 1e-7 * std::abs(c.end);
      EXPECT_NEAR(run(method, f, {c.start}, 20, {1e-9, 1e-19})[0], c.end, allowed) << c.name << " " << method;
      EXPECT_GT(std::abs(run(method, f, {c.start}, 20, {0.03, 1e-12})[0] - c.end), allowed)
          << c.name << " control";
    }
  }
}

TEST(OdeExplicit, DetestClassD) {
  for (const double e : {0.1, 0.5, 0.9}) {
    check("Kepler", kepler_orbit(), kepler_start(e), 20, kepler_state(e, 20), 1e-6, 1e-10, 1e-3);
  }
  // The closed form itself against the case's digits.
  EXPECT_LT(largest_difference(kepler_state(0.9, 20), {-1.2952662509875743677, 0.40039389637923215273,
                                                       -0.67753909247075658875, -0.12708381542786861877}),
            1e-13);
}

TEST(OdeExplicit, KeplerOfEccentricity099) {
  const std::vector<double> end = {-1.97373758141097163, -0.02533735150527517338, 0.090993314737247286587,
                                   -0.0703040928558162193};
  check("Kepler e = 0.99", kepler_orbit(), kepler_start(0.99), 3.5, end, 1e-7, 1e-12, 1e-4);
}

TEST(OdeExplicit, DetestB5RigidBody) {
  const auto f = equations(3, [](double, const double* y, double* d) {
    d[0] = y[1] * y[2], d[1] = -y[0] * y[2], d[2] = -0.51 * y[0] * y[1];
  });
  check("B5", f, {0, 1, 1}, 20, {-0.93965707987292039619, -0.34211777540007490653, 0.74141265961999530078},
        1e-7, 1e-10, 1e-3);
}

TEST(OdeExplicit, Pleiades) {
  check("Pleiades", pleiades(), pleiades_start(), 3, pleiades_end(), 1e-6, 1e-11, 1e-4);
}

TEST(OdeExplicit, ArenstorfCloses) {
  check("Arenstorf", arenstorf(), arenstorf_start(), kArenstorfPeriod, {0.994, 0}, 1e-6, 1e-12, 1e-5);
}

TEST(OdeExplicit, FigureEightCloses) {
  const double p = 0.34711688811892693824277692032, q = 0.532724945388030229262027987692;
  const auto f = motions(6, GravityForce{{1, 1, 1}, 1, 2});
  const std::vector<double> start = {-1, 0, 1, 0, 0, 0, p, q, p, q, -2 * p, -2 * q};
  check("figure eight", f, start, 6.32591398292621167758900033397, start, 1e-9, 1e-13, 1e-6);
}

TEST(OdeExplicit, HenonHeiles) {
  const auto f = motions(2, [](const double* q, double* a) {
    a[0] = -q[0] - 2 * q[0] * q[1], a[1] = -q[1] - q[0] * q[0] + q[1] * q[1];
  });
  const auto energy = [](const std::vector<double>& y) {
    return 0.5 * (y[2] * y[2] + y[3] * y[3] + y[0] * y[0] + y[1] * y[1]) + y[0] * y[0] * y[1] -
           y[1] * y[1] * y[1] / 3;
  };
  const std::vector<double> start = {0.1, 0, 0, 0.5},
                            at_100 = {-0.040194237876068816794, 0.67901692177202164213,
                                      0.038450928951859834502, 0.048594831553003642243};
  check("Henon-Heiles", f, start, 100, at_100, 1e-8, 1e-12, 1e-5);
  for (const char* method : {"dop853", "rkn86", "rkn1210", "ias15"}) {
    EXPECT_NEAR(energy(run(method, f, start, 1000, {1e-13, 1e-13})), energy(start), 1e-10) << method;
  }
  EXPECT_GT(std::abs(energy(run("tsit5", f, start, 1000, {1e-6, 1e-6})) - energy(start)), 1e-10) << "control";
}

TEST(OdeExplicit, LotkaVolterra) {
  const auto f = equations(2, [](double, const double* y, double* d) {
    d[0] = 1.5 * y[0] - y[0] * y[1], d[1] = -3 * y[1] + y[0] * y[1];
  });
  check("Lotka-Volterra", f, {1, 1}, 10, {1.02634476757508932, 0.909691078136041618}, 1e-8, 1e-12, 1e-5);
}

TEST(OdeExplicit, Duffing) {
  const auto f = motions(1, [](const double* x, double* a) { a[0] = -x[0] - x[0] * x[0] * x[0]; });
  check("Duffing", f, {1, 0}, 10, {0.79887476899741432621}, 1e-9, 1e-12, 1e-5);
}

TEST(OdeExplicit, OuterSolarSystem) {
  const GravityForce force = outer_solar_force();
  const auto f = motions(18, force);
  const std::vector<double> start = outer_solar_start();
  const std::vector<double> at_10000 = {0.0533060881722553307, -0.0280528039444594987, -0.0136367787759701802,
                                        4.76168862181336727,   -1.49853165620614067,   -0.758534323470254016,
                                        7.08434663967275448,   -6.37841342141230047,   -2.93937167831273472,
                                        14.3974218862076141,   12.4421394804557882,    5.24500980681298515,
                                        29.695174558793546,    -3.48399956191029737,   -2.16616668849387982,
                                        15.2375921155866617,   -27.9480520130401396,   -13.2994248502006895};
  check("outer solar system", f, start, 10000, at_10000, 1e-10, 1e-15, 1e-8);
  // Relative energy: 1e-15 after 1e5 days (the end's own rounding is 2e-16); leapfrog at 10 days conserves it
  // to 5e-6, with explicit Euler as its control.
  const long double before = force.energy(start.data());
  const auto drift = [&](const std::vector<double>& y) {
    return static_cast<double>(std::abs(force.energy(y.data()) / before - 1));
  };
  EXPECT_LT(drift(run("ias15", f, start, 1e5, {1e-12, 1e-12})), 2e-15);
  EXPECT_GT(drift(run("dopri5", f, start, 1e5, {1e-12, 1e-12})), 2e-15) << "control";
  EXPECT_LT(drift(run("leapfrog", f, start, 2e5, {}, 20000)), 5e-6);
  EXPECT_GT(drift(run("euler", f, start, 2e5, {}, 20000)), 5e-6) << "control";
}

// In pieces of 10 days, as a session steps: the low-order parts of the sums are passed from call to call in
// `memory`. Without it every call rounds, and 10,000 roundings of 1e-16 make some 1e-14.
TEST(OdeExplicit, OuterSolarSystemInPieces) {
  const GravityForce force = outer_solar_force();
  const auto f = motions(18, force);
  const auto drift = [&](std::vector<double> memory) {
    auto y = outer_solar_start();
    const long double before = force.energy(y.data());
    Workspace workspace;
    Carry carry;
    for (int i = 0; i < 10000; ++i) {
      Advance advance{.f = f,
                      .t = 10.0 * i,
                      .t_end = 10.0 * (i + 1),
                      .y = y.data(),
                      .workspace = workspace,
                      .carry = carry,
                      .tolerance = {.relative = 1e-12, .absolute = 1e-12},
                      .memory = memory};
      find_integrator("ias15")->advance(advance);
    }
    return static_cast<double>(std::abs(force.energy(y.data()) / before - 1));
  };
  EXPECT_LT(drift(std::vector<double>(find_integrator("ias15")->memory(36), NAN)), 2e-15);
  EXPECT_GT(drift({}), 2e-15) << "control";
}

}  // namespace
}  // namespace truestep::test
