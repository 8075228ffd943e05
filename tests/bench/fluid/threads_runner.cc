// threads_runner CASE CELLS [STEPS]: wall-clock time of a step with one thread and with two, which take
// turns, as medians (s), their ratio, and whether both ended with the same bits. CASE is smoke (warm smoke
// around a ball in a cube of CELLS each way), flip or apic (a column of liquid of 1/2 x 4/5 x 1 collapses in
// a box of CELLS x 5/8 CELLS x CELLS/2). With STEPS below 0 only two threads run, for a profiler.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/support/fluids/grid_flow.h"
#include "tests/support/fluids/liquid_grid.h"

namespace {
using namespace truestep;
using namespace truestep::grid_fluid;

GridFluidDef smoke(int64_t n) {
  GridFluidDef d;
  d.cells = {n, n, n}, d.size = {1, 1, 1}, d.origin = {-0.5, 0, -0.5};
  d.advection = GridFluidDef::Advection::maccormack;
  d.all = FlowSideDef{SideKind::slip, {}};
  d.sides.y_max = FlowSideDef{SideKind::outflow, {}};
  d.scalar.emplace();
  d.scalar->source = "x^2 + z^2 + (y - 0.15)^2 < 0.015 ? 5 : 0", d.scalar->expansion = 0.2;
  d.vorticity_confinement = 0.3, d.tolerance = 1e-6;
  d.obstacles.resize(1);
  d.obstacles[0].center = {0.02, 0.5, 0}, d.obstacles[0].radius = 0.12;
  return d;
}

GridFluidDef dam(GridFluidDef::Advection advection, int64_t n) {
  GridFluidDef d = test::water(advection, {n, n * 5 / 8, n / 2}, 1.6 / static_cast<double>(n));
  d.bodies = {test::box_of_liquid({0, 0, 0}, {0.6, 0.8, 0.8})};
  return d;
}

template <class Run>
int measure(Run& one, Run& two, int steps) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> spent[2];
  for (int n = 0; n < std::abs(steps); ++n) {
    for (const size_t k : {0, 1}) {
      if (k == 0 && steps < 0) continue;
      const auto before = Clock::now();
      (k == 0 ? one : two).steps(1);
      spent[k].push_back(std::chrono::duration<double>(Clock::now() - before).count());
    }
  }
  if (steps < 0) return 0;
  double median[2];
  for (const size_t k : {0, 1}) {
    std::sort(spent[k].begin(), spent[k].end());
    median[k] = spent[k][spent[k].size() / 2];
  }
  const bool same = one.state.hash() == two.state.hash();
  std::printf("%.6f %.6f %.3f %s\n", median[0], median[1], median[0] / median[1], same ? "same" : "DIFFER");
  return same ? 0 : 1;
}
}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) return 2;
  const std::string what = argv[1];
  const int64_t n = std::atoll(argv[2]);
  const int steps = argc == 4 ? std::atoi(argv[3]) : 9;
  if (n < 8) return 2;
  if (what == "smoke") {
    test::GridFlow one(smoke(n), 0.02, 1, {0, -9.81, 0}), two(smoke(n), 0.02, 2, {0, -9.81, 0});
    return measure(one, two, steps);
  }
  if (what != "flip" && what != "apic") return 2;
  const auto kind = what == "flip" ? GridFluidDef::Advection::flip : GridFluidDef::Advection::apic;
  test::LiquidRun one(dam(kind, n), 1.0 / 60, 1), two(dam(kind, n), 1.0 / 60, 2);
  return measure(one, two, steps);
}
