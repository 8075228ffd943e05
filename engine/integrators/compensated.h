// Sums whose rounding errors are carried along: y + low is what y would be in about twice the digits
// (Kahan 1965; the branch-free error of an addition: Knuth, TAOCP 2, section 4.2.2, theorem B).
#pragma once

namespace truestep {

/// sum + low = a + b exactly, sum = a + b rounded.
struct TwoSum {
  double sum, low;
};
inline TwoSum two_sum(double a, double b) {
  const double sum = a + b, part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

}  // namespace truestep
