// Seams of a surface in space that is made of several bodies or parts, as the plane's (flat/seam.h): edges
// and sides that are covered by the piece beside them, on which nothing may catch.
#pragma once
#include <cstdint>
#include <optional>

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

/// The normal (in the world) of the face on which the ground is touched; empty at its edges. The normal of
/// the contact may lean by a hundredth: that of a face of the body.
std::optional<Vec3> floor_normal(const Touched& ground);
/// Ground on which a body stands, and the normal of its face.
struct Floor {
  Touched ground;
  Vec3 up;
};

/// What a contact with `beside` is to a body that stands on a floor, where it touches an edge or side that
/// lies in the floor's plane, within its borders, and rises nowhere above it.
enum class Seam : uint8_t {
  none,
  goes_on,  ///< along the floor: it is touched along that face's normal, not as an edge that leans
  covered   ///< what moves along the floor must not touch it
};
/// `flush` (m): steps as high as that count as flush; `deep` (m): what bodies sink in.
Seam seam(const Touched& beside, const Floor& floor, double flush, double deep);

}  // namespace truestep
