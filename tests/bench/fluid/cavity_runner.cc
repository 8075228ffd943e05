// cavity_runner CELLS METHOD [REYNOLDS]: processor time (s) in which the flow in the cavity is found on so
// many cells each way, the root mean square of its error against what is published
// (tests/support/fluids/cavity.h) and the largest one. METHOD is second or fourth, the steady flow, at
// Reynolds numbers above 1000 by way of lower ones; or an `advection`, stepped for 60 s.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

#include "tests/support/fluids/cavity.h"

int main(int argc, char** argv) {
  using namespace truestep;
  using D = grid_fluid::GridFluidDef;
  if (argc < 3 || argc > 4) return 2;
  const std::string method = argv[2];
  const int reynolds = argc == 4 ? std::atoi(argv[3]) : 1000;
  if (test::cavity_profiles(reynolds).u.empty()) return 2;
  D d = test::steady_cavity(std::atoll(argv[1]), method == "fourth" ? D::Order::fourth : D::Order::second);
  const bool steady = method == "second" || method == "fourth";
  double now = std::min(reynolds, 1000);
  d.viscosity = 1.0 / now;
  if (!steady) {
    d.viscosity = 1.0 / reynolds, d.stepping = D::Stepping::rk3;
    d.advection = method == "maccormack" ? D::Advection::maccormack
                  : method == "bfecc"    ? D::Advection::bfecc
                  : method == "central"  ? D::Advection::central
                                         : D::Advection::semi_lagrangian;
  }
  const std::clock_t before = std::clock();
  test::GridFlow run(d, steady ? 1 : 0.1);
  try {
    run.steps(steady ? 1 : 600);
    // Each flow is the start of the next.
    constexpr double kStep = 1.15;
    while (steady && now < reynolds) {
      now = std::min(now * kStep, double(reynolds));
      run.system->apply(run.state,
                        {.kind = CommandKind::set_parameter, .value = 1 / now, .name = "viscosity"});
      run.steps(1);
      std::fprintf(stderr, "Re %.0f: %.0f iterations\n", now, run.observed("steady.iterations"));
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s at a Reynolds number of %.0f\n", e.what(), now);
    return 1;
  }
  const double seconds = double(std::clock() - before) / CLOCKS_PER_SEC;
  const test::CavityError error = test::cavity_error(run, reynolds);
  std::printf("%.6f %.6e %.6e\n", seconds, error.rms, error.largest);
}
