// A thing that a comparison of engines takes for granted, and what an engine says to it.
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
