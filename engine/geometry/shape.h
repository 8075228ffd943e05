// Solids that points collide with, their pose and their prescribed motion:
//   position(t) = p0 + velocity t + amplitude (sin(2 pi f t + phase) - sin(phase)),
//   orientation(t) = R(spin t) q0
#pragma once
#include <cstdint>

#include "engine/geometry/shape_distance.h"
#include "engine/math/quaternion.h"

namespace truestep {

enum class ShapeKind : uint8_t { plane, box, sphere, capsule };
/// Where points stay: outside a solid or inside a container. A plane has its solid below the normal.
enum class PointSide : uint8_t { outside, inside };

struct Shape {
  ShapeKind kind = ShapeKind::sphere;
  PointSide side = PointSide::outside;
  Vec3 size{1, 0, 0};  ///< m; plane: unit normal; box: half extents; sphere: (r, -, -); capsule: (r, half
                       ///< length of its y axis, -)
};

struct Pose {
  Vec3 position;
  Quat orientation;
};

/// Signed distance to the solid (not mirrored for containers) of a point in the shape's own frame.
inline SurfaceDistance<double> solid_distance(const Shape& s, const Vec3& p) {
  switch (s.kind) {
    case ShapeKind::plane:
      return plane_distance(p, s.size);
    case ShapeKind::box:
      return box_distance(p, s.size);
    case ShapeKind::sphere:
      return sphere_distance(p, s.size.x);
    case ShapeKind::capsule:
      break;
  }
  return capsule_distance(p, s.size.x, s.size.y);
}

/// Radius (m) of the enclosing ball about the shape's origin; infinity for a plane.
double bounding_radius(const Shape& s);

/// Motion prescribed as a function of time; all zero: at rest.
struct ShapeMotion {
  Vec3 velocity;         ///< m/s
  Vec3 amplitude;        ///< m
  double frequency = 0;  ///< Hz
  double phase = 0;      ///< rad
  Vec3 spin;             ///< rad/s, world axes

  bool at_rest() const;
};

/// Pose at time t (s) of a shape whose pose at t = 0 is `start`.
Pose moved(const Pose& start, const ShapeMotion& motion, double t);

}  // namespace truestep
