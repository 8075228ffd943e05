// How long a test waits before it calls something hung: `seconds` of an idle machine, times what
// TRUESTEP_SLOWDOWN says (tests/slowdown.py), at least four.
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
