#include "tests/bench/report.h"

#include <time.h>

#include <algorithm>
#include <boost/json.hpp>
#include <chrono>
#include <iostream>

namespace truestep::bench {
namespace {

boost::json::value number_or_null(const std::optional<double>& x) {
  return x ? boost::json::value(*x) : boost::json::value(nullptr);
}

}  // namespace

void report(const Comparison& c) {
  const double ratio = c.better == Comparison::Better::lower ? c.peer / c.ours : c.ours / c.peer;
  std::cout << boost::json::object{{"bench", c.bench},
                                   {"metric", c.metric},
                                   {"ours", c.ours},
                                   {"peer", c.peer},
                                   {"peer_name", c.peer_name},
                                   {"ratio", ratio},
                                   {"error_ours", number_or_null(c.error_ours)},
                                   {"error_peer", number_or_null(c.error_peer)},
                                   {"threads", c.threads}}
            << std::endl;
}

double now_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median(double* values, int count) {
  std::nth_element(values, values + count / 2, values + count);
  return values[count / 2];
}

}  // namespace truestep::bench
