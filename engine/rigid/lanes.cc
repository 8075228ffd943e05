#include "engine/rigid/lanes.h"

#include <algorithm>
#include <iterator>

namespace truestep {

void make_lanes(std::span<const uint32_t> items, std::span<const ConstraintEnds> ends,
                std::span<const uint8_t> last, size_t bodies, uint32_t lanes, LaneColouring& memory,
                LaneGroups& out) {
  const size_t n = items.size();
  memory.colour.resize(n), memory.order.resize(n), memory.used.resize(bodies);
  std::array<uint32_t, kColours + 1> count;
  colour_constraints(ends, memory.used, memory.colour, count);
  sort_by_colour(memory.colour, count, memory.order);
  if (!last.empty()) {
    memory.sorted.clear();
    auto begin = memory.order.begin();
    for (const uint32_t c : count) {
      for (const uint8_t behind : {0, 1}) {
        std::copy_if(begin, begin + c, std::back_inserter(memory.sorted),
                     [&](uint32_t i) { return last[i] == behind; });
      }
      begin += c;
    }
    memory.order.swap(memory.sorted);
  }
  out.member.clear(), out.colour_begin.assign(1, 0);
  const auto close = [&] { out.colour_begin.push_back(static_cast<uint32_t>(out.member.size() / lanes)); };
  size_t next = 0;
  for (uint32_t c = 0; c <= kColours; ++c) {
    if (count[c] == 0) continue;
    // Constraints left over may share bodies: one per group, and one group after the other.
    const uint32_t filled = c < kColours ? lanes : 1;
    for (uint32_t k = 0; k < count[c]; k += filled) {
      for (uint32_t lane = 0; lane < lanes; ++lane) {
        const bool holds = lane < filled && k + lane < count[c];
        out.member.push_back(holds ? items[memory.order[next + k + lane]] : kNoBody);
      }
      if (c == kColours) close();
    }
    next += count[c];
    if (c < kColours) close();
  }
  out.count = out.member.size() / lanes;
}

}  // namespace truestep
