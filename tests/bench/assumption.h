// An assumption of a comparison between engines, and an engine's answer to it.
#pragma once
#include <cmath>
#include <string>

namespace truestep::bench {

struct Assumption {
  std::string what;
  double expected, tolerance, measured;
  bool holds() const { return std::abs(measured - expected) <= tolerance; }
};

}  // namespace truestep::bench
