// Seams of a surface in space that is made of several bodies or parts, as the plane's (flat/seam.h): edges
// and sides that are covered by the piece beside them, on which nothing may catch.
#pragma once
#include "engine/collision/pairs/manifold.h"
#include "engine/geometry/solid.h"
#include "engine/geometry/transform.h"

namespace truestep {

/// A piece of ground, and a contact with it.
struct Touched {
  const Solid& solid;
  const Transform& at;
  uint32_t part;  ///< triangle or part of the compound
  Vec3 normal;    ///< unit, from the ground to the body that touches it
  Vec3 point;     ///< m, on the ground's surface
};

/// True where the body stands on a face of `ground`, and touches an edge or side of `beside` that lies in the
/// plane of that face, within its borders, and rises nowhere above it: what moves along `ground` must not
/// touch it. `flush` (m): steps as high as that count as flush; `deep` (m): what bodies sink in.
bool is_seam(const Touched& beside, const Touched& ground, double flush, double deep);

}  // namespace truestep
