// Constraints of a step in SIMD lanes: sorted by colour into groups of as many constraints as a register has
// lanes.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "engine/base/thread_team.h"
#include "engine/math/vec3.h"
#include "engine/math/wide.h"
#include "engine/rigid/colours.h"
#include "engine/rigid/constraint_colouring.h"

namespace truestep {

/// Groups per task.
inline constexpr size_t kGroupsPerBlock = 8;

/// The lanes of all groups, colour by colour.
struct LaneGroups {
  std::vector<uint32_t> member;        ///< item in a lane, or kNoBody
  std::vector<uint32_t> colour_begin;  ///< first group of every colour, and the end
  size_t count = 0;
};

/// Scratch memory of make_lanes.
struct LaneColouring {
  std::vector<uint32_t> order, sorted;
  std::vector<uint64_t> used;
  std::vector<uint8_t> colour;
};

/// Groups of `lanes` items; ends[i]: the moving bodies of items[i], below `bodies`; last[i], if given: 1 for
/// items sorted behind the others of their colour, so that they share groups with items of their kind.
void make_lanes(std::span<const uint32_t> items, std::span<const ConstraintEnds> ends,
                std::span<const uint8_t> last, size_t bodies, uint32_t lanes, LaneColouring& memory,
                LaneGroups& out);

/// body(group) for all groups, those of a colour in parallel.
template <class Groups, class Body>
void each_colour(const LaneGroups& lanes, Groups& all, const ThreadTeam& team, ColourOrder order,
                 Body&& body) {
  each_colour(lanes.colour_begin, order, team, kGroupsPerBlock, [&](size_t g) { body(all[g]); });
}

template <class Groups, class Body>
void each_colour(const LaneGroups& lanes, Groups& all, const ThreadTeam& team, Body&& body) {
  each_colour(lanes, all, team, ColourOrder::forth, body);
}

template <class T>
void set3(Wide<T> out[3], int lane, const Vec3& v) {
  out[0].set(lane, T(v.x)), out[1].set(lane, T(v.y)), out[2].set(lane, T(v.z));
}

}  // namespace truestep
