// The cost of solving implicit Euler's full equations beside its one-step linearization, on a cloth of 100 x
// 100 points at 1/60 s that falls, swings and buckles for a second. Both start every step from the same
// state, that of the full equations, so that the errors are those of one step's positions.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "engine/integrators/implicit/newton/stage_newton.h"
#include "engine/integrators/table/integrators.h"
#include "engine/systems/mass_spring/mass_spring.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;
using namespace truestep::mass_spring;

MassSpringDef cloth() {
  MassSpringDef d;
  d.cloth_grid = ClothGridShape{.nx = 100, .ny = 100};
  d.mass = 1e-3, d.stiffness = 1000, d.shear_stiffness = 500, d.bending_stiffness = 100;
  d.pinned = {"corner_00", "corner_10"};
  return d;
}

}  // namespace

int main() {
  constexpr int kSteps = 60;
  constexpr double kStep = 1.0 / 60;
  const MassSpringField field(cloth(), {.id = "cloth"});
  const Integrator &full = *find_integrator("implicit_euler"),
                   &linear = *find_integrator("linear_implicit_euler");
  const ThreadArena arena(1);
  Workspace workspace, linear_workspace;
  State state = field.initial_state(), before = state;
  std::vector<double> full_times, linear_times;
  int iterations = 0, solves = 0, most = 0;
  double worst = 0;
  for (uint64_t n = 0; n < kSteps; ++n) {
    before = state;
    State other = state;
    const double t = double(n) * kStep, start = bench::thread_seconds();
    full.step(field, state, {.t = t, .h = kStep, .step = n, .workspace = workspace, .arena = arena}, {});
    const double middle = bench::thread_seconds();
    linear.step(field, other, {.t = t, .h = kStep, .step = n, .workspace = linear_workspace, .arena = arena},
                {});
    // The first step sets memory aside.
    if (n > 0) full_times.push_back(middle - start), linear_times.push_back(bench::thread_seconds() - middle);
    const auto& report = workspace.object<NewtonReport>(kNewtonReport);
    iterations += report.iterations, solves += report.solves, most = std::max(most, report.iterations);
    const auto x = state.f64(MassSpringColumns::position), y = other.f64(MassSpringColumns::position);
    for (size_t k = 0; k < x.size(); ++k) worst = std::max(worst, std::abs(x[k] - y[k]));
  }
  std::fprintf(stderr, "%.2f iterations and %.2f linear systems per step, %d iterations at most\n",
               double(iterations) / kSteps, double(solves) / kSteps, most);
  bench::report({.bench = "newton_cloth",
                 .metric = "CPU seconds per step, cloth 100 x 100",
                 .ours = bench::median(full_times.data(), int(full_times.size())),
                 .peer = bench::median(linear_times.data(), int(linear_times.size())),
                 .peer_name = "linear_implicit_euler",
                 .error_ours = 0,
                 .error_peer = worst});
}
