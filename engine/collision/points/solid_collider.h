// Colliders given by their surface alone, for matter that asks no more of a collider than its distance:
// meshes that enclose a volume, and the ground under a height field. Points that bounce are not checked
// against them.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "engine/collision/points/collider_def.h"
#include "engine/core/drawing.h"
#include "engine/geometry/solid.h"
#include "engine/geometry/transform.h"

namespace truestep {

struct SolidCollider {
  std::string id;
  size_t index = 0;  ///< in the scene's list
  Solid solid;
  PointSide side = PointSide::outside;
  Pose start;  ///< at t = 0
  ShapeMotion motion;
  DrawnShape drawn;  ///< at the start

  Transform place(double t) const { return transform_of(moved(start, motion, t)); }
  /// m/s, of the material at x at time t.
  Vec3 velocity_at(const Vec3& x, double t) const;
  /// For drawing, at time t.
  DrawnShape drawn_at(double t) const;
};

/// The meshes and height fields of a list. Ground goes on for `around` m beyond its border and below its
/// lowest height.
std::vector<SolidCollider> build_solid_colliders(const AnyColliderDefs& defs, double around);

}  // namespace truestep
