// Contact of two outlines: one or two points with a common normal, found by separating axes over the edges,
// clipping against the reference edge, and a corner-corner normal where the edges do not face one another.
#pragma once
#include <array>
#include <cstdint>

#include "engine/collision/flat/outline.h"

namespace truestep::flat {

enum class Side : uint8_t { a, b };
/// Whose edge the normal belongs to; none: it runs from corner to corner.
enum class Face : uint8_t { none, of_a, of_b };

struct ContactPoint {
  Vec2 at;                   ///< midway between the two surfaces, in the frame of a
  double separation = 0;     ///< m along the normal, negative where they overlap
  uint32_t id = 0;           ///< the same features of the same two outlines have the same id
  Side corner_of = Side::a;  ///< whose corner bounds the contact there; either of them from corner to corner
};

struct Contact {
  Vec2 normal;  ///< unit, from a to b, in the frame of a
  std::array<ContactPoint, 2> point{};
  uint32_t points = 0;
  Face face = Face::none;
};

/// Points of a and b (at pose `b_in_a` seen from a) closer than `margin`; false when there are none. A link
/// touches only bodies on its solid sides, and leaves contacts of shared corners to the neighbour that owns
/// them; two links never touch.
bool touch(const Outline& a, const Outline& b, const Pose& b_in_a, double margin, Contact& out);

}  // namespace truestep::flat
