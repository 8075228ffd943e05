// How long a test waits before it declares something hung: `seconds` on an idle machine, times
// TRUESTEP_SLOWDOWN (tests/slowdown.py), but at least four times.
#pragma once
#include <chrono>
#include <cstdlib>

namespace truestep {

inline std::chrono::milliseconds patience(double seconds) {
  const char* said = std::getenv("TRUESTEP_SLOWDOWN");
  const double slowdown = said ? std::atof(said) : 0;
  return std::chrono::milliseconds(static_cast<int64_t>(1000 * seconds * (slowdown > 4 ? slowdown : 4)));
}

}  // namespace truestep
