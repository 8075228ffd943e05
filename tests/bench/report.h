// Output of a benchmark: one JSON line per comparison of ours with a peer's, run interleaved in one process
// or one script. Ratio > 1 means that ours is better. The driver (driver.py) checks and collects the lines.
#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace truestep::bench {

/// One comparison. `ours` and `peer` are in the unit that `metric` names ("seconds per step", "requests/s").
struct Comparison {
  std::string bench;
  std::string metric;
  double ours = 0;
  double peer = 0;
  std::string peer_name;
  enum class Better { lower, higher } better = Better::lower;
  std::optional<double> error_ours =
      {};  ///< in the same measure for both, absent where nothing is approximated
  std::optional<double> error_peer = {};
  int threads = 1;
};

/// Writes the line to stdout.
void report(const Comparison& comparison);

/// Wall seconds since an arbitrary moment.
double now_seconds();

/// Medians of `rounds` interleaved runs of both, in seconds: a busy machine affects both alike.
struct Times {
  double ours, peer;
};
template <class Ours, class Peer>
Times interleaved(int rounds, Ours&& ours, Peer&& peer);

/// CPU seconds of the calling thread: the measure least affected by a busy machine, for single-threaded work.
double thread_seconds();

/// Like interleaved, with the quartiles of the rounds' ratios ours / peer: disturbances during one half of a
/// round show in their spread.
struct Paired {
  Times times;
  double low, middle, high;
};
template <class Ours, class Peer>
Paired paired(int rounds, Ours&& ours, Peer&& peer, double (*clock)() = now_seconds);

/// Middle element; values are reordered.
double median(double* values, int count);

template <class Ours, class Peer>
Paired paired(int rounds, Ours&& ours, Peer&& peer, double (*clock)()) {
  std::vector<double> a, b, ratio;
  for (int i = 0; i < rounds; ++i) {
    const double t0 = clock();
    ours();
    const double t1 = clock();
    peer();
    a.push_back(t1 - t0);
    b.push_back(clock() - t1);
    ratio.push_back(a.back() / b.back());
  }
  std::sort(ratio.begin(), ratio.end());
  const auto quartile = [&](size_t k) { return ratio[(ratio.size() - 1) * k / 4]; };
  return {{median(a.data(), rounds), median(b.data(), rounds)}, quartile(1), quartile(2), quartile(3)};
}

template <class Ours, class Peer>
Times interleaved(int rounds, Ours&& ours, Peer&& peer) {
  return paired(rounds, ours, peer).times;
}

}  // namespace truestep::bench
