// What a benchmark prints: one JSON line per comparison of ours with a peer's, run interleaved in one process
// or one script. Ratio > 1 means that we are better. The driver (driver.py) checks and collects the lines.
#pragma once
#include <optional>
#include <string>

namespace truestep::bench {

/// One comparison. `ours` and `peer` are in the unit that `metric` names ("seconds per step", "requests/s").
struct Comparison {
  std::string bench;
  std::string metric;
  double ours = 0;
  double peer = 0;
  std::string peer_name;
  enum class Better { lower, higher } better = Better::lower;
  std::optional<double> error_ours;  ///< in the same measure for both, absent where nothing is approximated
  std::optional<double> error_peer;
  int threads = 1;
};

/// Writes the line to stdout.
void report(const Comparison& comparison);

/// Wall seconds since an arbitrary moment.
double now_seconds();

/// Medians of `rounds` interleaved runs of both, in seconds: a busy machine disturbs both alike.
struct Times {
  double ours, peer;
};
template <class Ours, class Peer>
Times interleaved(int rounds, Ours&& ours, Peer&& peer);

/// Middle element; values are reordered.
double median(double* values, int count);

template <class Ours, class Peer>
Times interleaved(int rounds, Ours&& ours, Peer&& peer) {
  constexpr int kMost = 101;
  double a[kMost], b[kMost];
  if (rounds > kMost) rounds = kMost;
  for (int i = 0; i < rounds; ++i) {
    const double t0 = now_seconds();
    ours();
    const double t1 = now_seconds();
    peer();
    a[i] = t1 - t0;
    b[i] = now_seconds() - t1;
  }
  return {median(a, rounds), median(b, rounds)};
}

}  // namespace truestep::bench
