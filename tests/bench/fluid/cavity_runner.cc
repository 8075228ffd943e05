// cavity_runner CELLS second|fourth: processor time (s) in which the steady cavity at a Reynolds number of
// 1000 is found on so many cells each way, and the root mean square of its error against the spectral
// columns.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "tests/support/cavity.h"

int main(int argc, char** argv) {
  using namespace truestep;
  if (argc != 3) return 2;
  const auto order = std::strcmp(argv[2], "fourth") == 0 ? grid_fluid::GridFluidDef::Order::fourth
                                                         : grid_fluid::GridFluidDef::Order::second;
  const std::clock_t before = std::clock();
  test::GridFlow run(test::steady_cavity(std::atoll(argv[1]), order), 1);
  run.steps(1);
  const double seconds = double(std::clock() - before) / CLOCKS_PER_SEC;
  std::printf("%.6f %.6e\n", seconds, test::cavity_rms(run));
}
