// Refinement of a box of cells: multiplies the numbers of cells along its axes (core/def/resolution.h).
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace truestep {

/// Multiplies the numbers of cells; returns the reason if they would not be whole, fewer than `least` or too
/// many.
inline std::optional<std::string> divide_cells(std::vector<int64_t>& cells, double factor, int64_t least) {
  constexpr double kMost = 5e7;  // in total
  double all = 1;
  for (int64_t& n : cells) {
    const double wanted = factor * static_cast<double>(n);
    if (wanted != std::floor(wanted) || wanted < static_cast<double>(least)) {
      return "numbers of cells must be whole and at least " + std::to_string(least);
    }
    all *= wanted;
    if (all > kMost) return "more than 5e7 cells";
    n = static_cast<int64_t>(wanted);
  }
  return std::nullopt;
}

}  // namespace truestep
