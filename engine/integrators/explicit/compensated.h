// Sums whose rounding errors are carried along: y + low is what y would be in about twice the digits (Kahan
// 1965; the branch-free error of an addition: Knuth, TAOCP 2, section 4.2.2, theorem B). The remainders of
// the last call are passed to the next in Advance::memory, together with the y that they belong to.
#pragma once
#include <algorithm>

#include "engine/integrators/advance.h"

namespace truestep {

/// sum + low = a + b exactly, sum = a + b rounded.
struct TwoSum {
  double sum, low;
};
inline TwoSum two_sum(double a, double b) {
  const double sum = a + b, part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

/// Layout: the lower parts of y, then y.
constexpr size_t sums_memory(size_t n) {
  return 2 * n;
}
/// Copies the lower parts belonging to in.y into `low`; false: there are none, zeros.
inline bool recall_sums(const Advance& in, double* low) {
  const size_t n = in.f.size();
  const double* memory = in.memory.data();
  const bool known = in.memory.size() >= sums_memory(n) && std::equal(in.y, in.y + n, memory + n);
  if (known) {
    std::copy_n(memory, n, low);
  } else {
    std::fill_n(low, n, 0.0);
  }
  return known;
}
/// After the last step: stores `low` for the next call. False: there is no memory for it.
inline bool remember_sums(const Advance& in, const double* low) {
  const size_t n = in.f.size();
  if (in.project && !in.memory.empty()) in.project(in.f, in.y);
  if (in.memory.size() < sums_memory(n)) return false;
  std::copy_n(low, n, in.memory.data());
  std::copy_n(in.y, n, in.memory.data() + n);
  return true;
}

}  // namespace truestep
