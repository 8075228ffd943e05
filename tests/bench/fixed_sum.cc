// The cost of one hash for every number of threads: our sum over fixed blocks beside std::reduce, which may
// add in any order. Error: relative, against the exact sum n (n + 1) / 2 of 1 ... n scaled by 1e-3.
#include <cmath>
#include <numeric>
#include <vector>

#include "engine/base/parallel.h"
#include "tests/bench/report.h"

int main() {
  constexpr size_t n = 1 << 20;
  std::vector<double> x(n);
  for (size_t i = 0; i < n; ++i) x[i] = 1e-3 * static_cast<double>(i + 1);
  const double exact = 1e-3 * static_cast<double>(n) * static_cast<double>(n + 1) / 2;

  const truestep::ThreadArena arena(1);
  double ours = 0, peer = 0;
  const auto block = [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += x[i];
    return sum;
  };
  const auto times = truestep::bench::interleaved(
      21, [&] { ours = arena.sum_blocks(n, truestep::kBlockRows, block); },
      [&] { peer = std::reduce(x.begin(), x.end()); });
  truestep::bench::report({.bench = "fixed_sum",
                           .metric = "seconds per sum of 2^20 doubles",
                           .ours = times.ours,
                           .peer = times.peer,
                           .peer_name = "std::reduce",
                           .error_ours = std::abs(ours / exact - 1),
                           .error_peer = std::abs(peer / exact - 1)});
}
