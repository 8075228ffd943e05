// Seams of a surface that is made of several shapes: edges and corners that are covered by the shape beside
// them, on which nothing may catch (as Jolt's "enhanced internal edge removal").
#pragma once
#include "engine/collision/flat/outline.h"

namespace truestep::flat {

/// A polygon in the world, and the unit normal from it towards a body that touches it.
struct Touched {
  const Outline& shape;
  Vec2 normal;
};

/// True where the body stands on an edge of `ground`, and the edge or corner of `beside` that it touches is
/// nowhere more than `flush` (m) above the line of that edge and ends on the edge, as close as that: what
/// moves along `ground` must not touch it.
bool is_seam(const Touched& beside, const Touched& ground, double flush);

}  // namespace truestep::flat
