// Energy over long runs. Kepler's orbit of eccentricity 0.2 over a million periods with 240 evaluations of
// the force per period: symplectic methods beside Boost.odeint's one of order 4 (McLachlan's SB3A with six
// stages), and rk4, which is not symplectic, for contrast. Then the outer solar system over 1e5 days with
// ias15 and others. Reported: the largest error of the whole run and the processor time; stderr shows the
// error in the first and the last tenth, equal where it is bounded. `--series` prints curves for plots
// instead, as one JSON object {kepler | solar: [{name, x, y}]}: the largest error within each of equal parts
// of a decade.
#include <array>
#include <boost/json.hpp>
#include <boost/numeric/odeint.hpp>
#include <cstdio>
#include <functional>
#include <iostream>
#include <string>

#include "engine/core/equations/integrator.h"
#include "engine/integrators/advance.h"
#include "engine/integrators/table/integrators.h"
#include "tests/bench/report.h"
#include "tests/support/ode_problems.h"

namespace truestep::bench {
namespace {

constexpr double kPeriod = 2 * M_PI, kPeriods = 1e6, kEccentricity = 0.2;
constexpr int kEvaluations = 240;  // per period
constexpr int kPartsOfDecade = 8;

struct Result {
  double seconds = 0, early = 0, late = 0, all = 0;
  std::vector<double> x = {}, y = {};
};

/// error_after(t) advances to time t, or as close to it as possible, and returns (time reached, |relative
/// energy error|).
using Watched = std::function<std::pair<double, double>(double t)>;

Result watch(const char* name, double from, double to, int looks, const Watched& error_after) {
  Result r;
  const double t0 = thread_seconds();
  const int parts = static_cast<int>(std::lround(std::log10(to / from) * kPartsOfDecade));
  double begin = 0;
  for (int part = 0; part <= parts; ++part) {
    const double end = from * std::pow(10.0, static_cast<double>(part) / kPartsOfDecade);
    double worst = 0;
    for (int look = 1; look <= looks; ++look) {
      const auto [t, error] = error_after(begin + (end - begin) * look / looks);
      worst = std::max(worst, error);
      if (t <= 0.1 * to) r.early = std::max(r.early, error);
      if (t >= 0.9 * to) r.late = std::max(r.late, error);
    }
    r.all = std::max(r.all, worst);
    r.x.push_back(end), r.y.push_back(worst);
    begin = end;
  }
  r.seconds = thread_seconds() - t0;
  std::fprintf(stderr, "%-20s %6.2f s, relative energy error: first tenth %.2e, last tenth %.2e\n", name,
               r.seconds, r.early, r.late);
  return r;
}

double kepler_energy(const double* y) {
  return 0.5 * (y[2] * y[2] + y[3] * y[3]) - 1 / std::sqrt(y[0] * y[0] + y[1] * y[1]);
}

/// advance(steps) returns y after that many more; h is one step.
template <class Advance>
Result watch_kepler(const char* name, int stages, Advance advance) {
  const double before = kepler_energy(test::kepler_start(kEccentricity).data());
  const double steps_per_period = static_cast<double>(kEvaluations) / stages;
  uint64_t done = 0;
  return watch(name, 1, kPeriods, 200, [&, done](double periods) mutable {
    const auto wanted = static_cast<uint64_t>(std::llround(periods * steps_per_period));
    // An odd number of steps between samples, so that they fall on different phases.
    const uint64_t more = std::max<uint64_t>(1, wanted - std::min(wanted, done));
    done += more;
    return std::pair(static_cast<double>(done) / steps_per_period,
                     std::abs(kepler_energy(advance(more)) / before - 1));
  });
}

Result kepler(const char* name, int stages) {
  const auto f = test::kepler_orbit();
  const Integrator& row = *find_integrator(name);
  auto y = test::kepler_start(kEccentricity);
  Workspace workspace;
  Carry carry;
  const double h = kPeriod * stages / kEvaluations;
  return watch_kepler(name, stages, [&](uint64_t steps) {
    Advance in{.f = f,
               .t = 0,
               .t_end = h * static_cast<double>(steps),
               .y = y.data(),
               .workspace = workspace,
               .carry = carry,
               .fixed_steps = steps};
    row.advance(in);
    return y.data();
  });
}

Result odeint_kepler() {
  using Half = std::array<double, 2>;
  boost::numeric::odeint::symplectic_rkn_sb3a_mclachlan<Half> stepper;
  const auto start = test::kepler_start(kEccentricity);
  std::pair<Half, Half> state{{start[0], start[1]}, {start[2], start[3]}};
  std::array<double, 4> y;
  const auto force = [](const Half& x, Half& a) { test::KeplerForce()(x.data(), a.data()); };
  const double h = kPeriod * 6 / kEvaluations;
  return watch_kepler("odeint sb3a", 6, [&](uint64_t steps) {
    for (uint64_t i = 0; i < steps; ++i) stepper.do_step(force, state, 0.0, h);
    y = {state.first[0], state.first[1], state.second[0], state.second[1]};
    return y.data();
  });
}

/// Adaptive methods at a tolerance, fixed-step ones at `step` days.
Result solar(const char* name, double tolerance, double step) {
  const test::GravityForce force = test::outer_solar_force();
  const test::Motions<test::GravityForce> f(18, force);
  const Integrator& row = *find_integrator(name);
  auto y = test::outer_solar_start();
  const long double before = force.energy(y.data());
  Workspace workspace;
  Carry carry;
  std::vector<double> memory(4 * 18, NAN);  // as a session keeps it for ias15
  double t = 0;
  return watch(name, 100, 1e5, 20, [&](double end) {
    const auto steps = static_cast<uint64_t>(std::llround((end - t) / step));
    const bool fixed = row.stepping == Integrator::Stepping::fixed;
    if (end > t && (!fixed || steps > 0)) {
      Advance in{.f = f,
                 .t = 0,
                 .t_end = fixed ? step * static_cast<double>(steps) : end - t,
                 .y = y.data(),
                 .workspace = workspace,
                 .carry = carry,
                 .tolerance = {.relative = tolerance, .absolute = tolerance},
                 .fixed_steps = steps,
                 .memory = memory};
      row.advance(in);
      t += in.t_end;
    }
    return std::pair(t, static_cast<double>(std::abs(force.energy(y.data()) / before - 1)));
  });
}

boost::json::object curve(const std::string& name, const Result& r) {
  return {{"name", name},
          {"x", boost::json::array(r.x.begin(), r.x.end())},
          {"y", boost::json::array(r.y.begin(), r.y.end())}};
}

constexpr std::pair<const char*, int> kSymplectic[] = {{"velocity_verlet", 1}, {"yoshida4", 3},
                                                       {"pefrl", 4},           {"yoshida6", 7},
                                                       {"yoshida8", 15},       {"kahan_li8", 17}};

void series() {
  boost::json::array orbit, solar_curves;
  for (const auto& [name, stages] : kSymplectic) orbit.push_back(curve(name, kepler(name, stages)));
  orbit.push_back(curve("odeint sb3a", odeint_kepler()));
  orbit.push_back(curve("rk4 (not symplectic)", kepler("rk4", 4)));
  solar_curves.push_back(curve("ias15", solar("ias15", 1e-12, 0)));
  solar_curves.push_back(curve("rkn1210, tolerance 1e-13", solar("rkn1210", 1e-13, 0)));
  solar_curves.push_back(curve("dop853, tolerance 1e-13", solar("dop853", 1e-13, 0)));
  solar_curves.push_back(curve("kahan_li8, 100 days", solar("kahan_li8", 0, 100)));
  solar_curves.push_back(curve("leapfrog, 10 days", solar("leapfrog", 0, 10)));
  const auto force = test::outer_solar_force();
  const auto start = test::outer_solar_start();
  const boost::json::object given{{"g", force.g},
                                  {"masses", boost::json::array(force.masses.begin(), force.masses.end())},
                                  {"start", boost::json::array(start.begin(), start.end())}};
  std::cout << boost::json::object{{"kepler", orbit}, {"solar", solar_curves}, {"planets", given}}
            << std::endl;
}

void comparisons() {
  const Result peer = odeint_kepler();
  for (const auto& [name, stages] : kSymplectic) {
    const Result r = kepler(name, stages);
    const std::string what = std::string(name) + ", 1e6 periods of 240 evaluations: ";
    report({.bench = "ode_long_run",
            .metric = what + "energy error",
            .ours = r.all,
            .peer = peer.all,
            .peer_name = "odeint sb3a_mclachlan"});
    report({.bench = "ode_long_run",
            .metric = what + "CPU s",
            .ours = r.seconds,
            .peer = peer.seconds,
            .peer_name = "odeint sb3a_mclachlan",
            .error_ours = r.all,
            .error_peer = peer.all});
  }
}

}  // namespace
}  // namespace truestep::bench

int main(int count, char** arguments) {
  if (count > 1 && std::string(arguments[1]) == "--series")
    truestep::bench::series();
  else
    truestep::bench::comparisons();
}
