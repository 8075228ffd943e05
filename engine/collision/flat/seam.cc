#include "engine/collision/flat/seam.h"

#include <algorithm>

namespace truestep::flat {
namespace {

/// Cosine to an edge's normal above which a contact belongs to that edge.
constexpr double kOnEdge = 1 - 1e-4;

/// The edge of the shape that the contact belongs to; shape.corners if it belongs to a corner.
uint32_t edge_touched(const Touched& t) {
  uint32_t i = 0;
  while (i < t.shape.corners && dot(t.shape.normal[i], t.normal) < kOnEdge) ++i;
  return i;
}

uint32_t next_corner(const Outline& s, uint32_t i) {
  return i + 1 < s.corners ? i + 1 : 0;
}

}  // namespace

bool is_seam(const Touched& beside, const Touched& ground, double flush) {
  const uint32_t floor = edge_touched(ground);
  if (floor == ground.shape.corners) return false;
  const Vec2 up = ground.shape.normal[floor], from = ground.shape.corner[floor];
  const Vec2 edge = ground.shape.corner[next_corner(ground.shape, floor)] - from;
  const auto height = [&](Vec2 p) { return dot(up, p - from); };
  Vec2 top;
  if (const uint32_t side = edge_touched(beside); side < beside.shape.corners) {
    // It goes on along the ground.
    if (dot(beside.shape.normal[side], ground.shape.normal[floor]) > kOnEdge) return false;
    const Vec2 a = beside.shape.corner[side], b = beside.shape.corner[next_corner(beside.shape, side)];
    top = height(a) > height(b) ? a : b;
  } else {
    const auto corners = beside.shape.corner.begin();
    top = *std::max_element(corners, corners + beside.shape.corners,
                            [&](Vec2 a, Vec2 b) { return dot(a, beside.normal) < dot(b, beside.normal); });
  }
  const double length = norm(edge), along = dot(edge, top - from) / length;
  return std::abs(height(top)) <= flush && along >= -flush && along <= length + flush;
}

}  // namespace truestep::flat
