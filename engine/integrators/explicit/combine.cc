#include "engine/integrators/explicit/combine.h"

#include <cmath>

namespace truestep {

namespace {
// Four running maxima, and a sum that is NaN exactly when any element is NaN or infinite.
double largest_in(size_t begin, size_t end, const Combination& t, const double* y, ErrorScale scale) {
  double most[4] = {}, poison = 0;
  for (size_t i = begin; i < end; ++i) {
    double sum = 0;
    for (size_t j = 0; j < t.n; ++j) sum += t.c[j] * t.k[j][i];
    poison += sum * 0.0;
    const double size = std::abs(sum) / (scale.absolute + scale.relative * std::abs(y[i]));
    double& lane = most[i % 4];
    lane = size > lane ? size : lane;
  }
  return std::fmax(std::fmax(most[0], most[1]), std::fmax(most[2], most[3])) + poison;
}
}  // namespace

double largest(const Motion& m, size_t size, const Combination& t, const double* y, ErrorScale scale) {
  if (size <= kBlockElements) return largest_in(0, size, t, y, scale);
  const auto partial =
      m.input.workspace.doubles("integrator.partial", (size + kBlockElements - 1) / kBlockElements);
  m.input.arena.for_blocks(size, kBlockElements, [&](size_t begin, size_t end) {
    partial[begin / kBlockElements] = largest_in(begin, end, t, y, scale);
  });
  double most = 0;
  for (const double p : partial) most = p > most || p != p ? p : most;
  return most;
}

}  // namespace truestep
