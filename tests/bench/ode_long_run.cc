// Energy of symplectic methods over a million periods of Kepler's orbit of eccentricity 0.2, each with 240
// evaluations of the force per period, beside Boost.odeint's symplectic method of order 4 (McLachlan's SB3A
// with six stages). The error's largest values in the first and the last tenth of the run stand in stderr:
// they are equal where it is bounded. Reported: the largest of the whole run, and the processor time.
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cstdio>
#include <string>

#include "engine/core/integrator.h"
#include "engine/integrators/advance.h"
#include "tests/bench/report.h"
#include "tests/support/ode_problems.h"

namespace truestep::bench {
namespace {

constexpr double kPeriod = 2 * M_PI, kPeriods = 1e6;
// Places where energy is looked at: 2,000, at ever different phases.
constexpr int kLooks = 2000;
constexpr int kEvaluations = 240;

double energy(const double* y) {
  return 0.5 * (y[2] * y[2] + y[3] * y[3]) - 1 / std::sqrt(y[0] * y[0] + y[1] * y[1]);
}

struct Result {
  double seconds = 0, early = 0, late = 0, all = 0;
};

// advance(t, steps): moves y on by so many steps and returns it.
template <class Advance>
Result watch(const char* name, double e, int stages, Advance advance) {
  const auto start = test::kepler_start(e);
  const double before = energy(start.data());
  const auto per_look = static_cast<uint64_t>(kPeriods / kLooks * kEvaluations / stages);
  Result r;
  const double t0 = thread_seconds();
  for (int i = 0; i < kLooks; ++i) {
    const double* y = advance(per_look + static_cast<uint64_t>(i % 7));
    const double error = std::abs(energy(y) / before - 1);
    r.all = std::max(r.all, error);
    if (i < kLooks / 10) r.early = std::max(r.early, error);
    if (i >= kLooks - kLooks / 10) r.late = std::max(r.late, error);
  }
  r.seconds = thread_seconds() - t0;
  std::fprintf(stderr, "%-20s %6.2f s, relative energy error: first tenth %.2e, last tenth %.2e\n", name,
               r.seconds, r.early, r.late);
  return r;
}

Result ours(const char* name, double e, int stages) {
  const auto f = test::kepler_orbit();
  const Integrator& row = *find_integrator(name);
  auto y = test::kepler_start(e);
  Workspace workspace;
  Carry carry;
  const double h = kPeriod * stages / kEvaluations;
  return watch(name, e, stages, [&](uint64_t steps) {
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

Result odeint(double e) {
  using Half = std::array<double, 2>;
  boost::numeric::odeint::symplectic_rkn_sb3a_mclachlan<Half> stepper;
  const auto start = test::kepler_start(e);
  std::pair<Half, Half> state{{start[0], start[1]}, {start[2], start[3]}};
  std::array<double, 4> y;
  const auto force = [](const Half& x, Half& a) { test::KeplerForce()(x.data(), a.data()); };
  const double h = kPeriod * 6 / kEvaluations;
  return watch("odeint sb3a", e, 6, [&](uint64_t steps) {
    for (uint64_t i = 0; i < steps; ++i) stepper.do_step(force, state, 0.0, h);
    y = {state.first[0], state.first[1], state.second[0], state.second[1]};
    return y.data();
  });
}

}  // namespace
}  // namespace truestep::bench

int main() {
  using namespace truestep::bench;
  constexpr double kEccentricity = 0.2;
  const Result peer = odeint(kEccentricity);
  const std::pair<const char*, int> rows[] = {{"velocity_verlet", 1}, {"yoshida4", 3},  {"pefrl", 4},
                                              {"yoshida6", 7},        {"yoshida8", 15}, {"kahan_li8", 17}};
  for (const auto& [name, stages] : rows) {
    const Result r = ours(name, kEccentricity, stages);
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
