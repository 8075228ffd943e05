// The features of a body's shape that meet triangles and lines between points: corners and balls, edges and
// axes. Rims of cylinders are eight corners and no edges; planes, meshes and height fields have neither.
#pragma once
#include <vector>

#include "engine/core/ports/body_port.h"
#include "engine/geometry/solid.h"

namespace truestep::contact {

/// A point of a body that triangles may meet, or a ball around it.
struct BodyCorner {
  Vec3 at;            ///< m, in the body's frame
  double radius = 0;  ///< m
};

/// A straight edge of a body, or a capsule's axis, that edges of triangles and capsules may meet.
struct BodyEdge {
  Vec3 from, to;      ///< m, in the body's frame
  Vec3 outward;       ///< unit, between the normals of its faces; zero: every direction is outward
  double radius = 0;  ///< m
};

/// What the search needs to know of a form.
struct TouchForm {
  std::vector<BodyCorner> corners;
  std::vector<BodyEdge> edges;  ///< empty in the plane, where corners are the edges
  double inner = 0, reach = 0;  ///< m, radii of the inscribed and the enclosing ball
  BodyAccess::Space in = BodyAccess::Space::space;
};
TouchForm touch_form(const BodyForm& form, BodyAccess::Space space);

}  // namespace truestep::contact
