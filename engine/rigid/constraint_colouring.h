// Colouring of a constraint graph: constraints of one colour share no moving body, so that a colour can be
// solved in parallel. Greedy in the given order, and therefore a function of that order alone, whatever the
// number of threads. Constraints for which no colour is free are left over and must be solved one after the
// other.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>

namespace truestep {

inline constexpr uint32_t kColours = 63;  ///< colours 0 to 62; this one is for constraints left over
inline constexpr uint32_t kNoBody = 0xffffffff;

/// The moving bodies of a constraint; kNoBody stands for one that the solver does not move.
using ConstraintEnds = std::array<uint32_t, 2>;

/// Writes the colour of every constraint. `used` has one word per body and is overwritten; `count[c]` becomes
/// the number of constraints of colour c.
inline void colour_constraints(std::span<const ConstraintEnds> ends, std::span<uint64_t> used,
                               std::span<uint8_t> colour, std::span<uint32_t, kColours + 1> count) {
  for (uint64_t& u : used) u = 0;
  for (uint32_t& c : count) c = 0;
  constexpr uint64_t kLast = uint64_t{1} << kColours;
  uint64_t nobody = 0;
  for (size_t i = 0; i < ends.size(); ++i) {
    uint64_t& a = ends[i][0] == kNoBody ? nobody : used[ends[i][0]];
    uint64_t& b = ends[i][1] == kNoBody ? nobody : used[ends[i][1]];
    const auto c = static_cast<uint32_t>(std::countr_one((a | b) & (kLast - 1)));
    if (c < kColours) a |= uint64_t{1} << c, b |= uint64_t{1} << c;
    nobody = 0;
    colour[i] = static_cast<uint8_t>(c);
    ++count[c];
  }
}

/// Positions of the constraints sorted by colour, in their original order within each; `count` as above.
inline void sort_by_colour(std::span<const uint8_t> colour, std::span<const uint32_t, kColours + 1> count,
                           std::span<uint32_t> order) {
  std::array<uint32_t, kColours + 1> next;
  uint32_t sum = 0;
  for (uint32_t c = 0; c <= kColours; ++c) next[c] = sum, sum += count[c];
  for (size_t i = 0; i < colour.size(); ++i) order[next[colour[i]]++] = static_cast<uint32_t>(i);
}

}  // namespace truestep
