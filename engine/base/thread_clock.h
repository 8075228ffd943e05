// CPU time of the calling thread, for work with a CPU budget: a busy machine does not shorten it.
#pragma once
#include <ctime>

namespace truestep {

/// s.
inline double thread_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace truestep
