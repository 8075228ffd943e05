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
    const Outline& b = beside.shape;
    uint32_t at = 0;
    for (uint32_t k = 1; k < b.corners; ++k) {
      if (dot(b.corner[k], beside.normal) > dot(b.corner[at], beside.normal)) at = k;
    }
    top = b.corner[at];
    // What goes on upwards from there is a wall.
    const Vec2 before = b.corner[at > 0 ? at - 1 : b.corners - 1], after = b.corner[next_corner(b, at)];
    if (std::max(height(before), height(after)) > flush) return false;
  }
  const double length = norm(edge), along = dot(edge, top - from) / length;
  return std::abs(height(top)) <= flush && along >= -flush && along <= length + flush;
}

}  // namespace truestep::flat
