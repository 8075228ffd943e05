// How a scene describes colliders: "colliders": [{"type": "plane" | "box" | "sphere" | "capsule", ...}],
// shared by every system made of points.
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/collision/points/collider_set.h"
#include "engine/core/def/def.h"

namespace truestep {

struct MotionDef {
  Vec3 velocity, amplitude, spin;
  double frequency = 0, phase = 0;
};

/// Members common to colliders of every type.
struct ColliderCommonDef {
  std::string id;
  double friction = 0.3, restitution = 0.5, rest_speed = 0.01;
  std::optional<MotionDef> motion;
};

struct PlaneColliderDef : ColliderCommonDef {
  Vec3 point, normal{0, 1, 0};
};
struct BoxColliderDef : ColliderCommonDef {
  Vec3 center, half_extents{0.5, 0.5, 0.5}, axis{0, 1, 0};
  double angle = 0;
  bool container = false;
};
struct SphereColliderDef : ColliderCommonDef {
  Vec3 center;
  double radius = 0.5;
  bool container = false;
};
struct CapsuleColliderDef : ColliderCommonDef {
  Vec3 from{0, -0.5, 0}, to{0, 0.5, 0};
  double radius = 0.25;
  bool container = false;
};

using ColliderDef = std::variant<PlaneColliderDef, BoxColliderDef, SphereColliderDef, CapsuleColliderDef>;
using ColliderDefs = std::vector<ColliderDef>;

/// Names and tables of the alternatives in the order of ColliderDef, for TableOf::variants.
std::vector<std::pair<std::string, const DefTable*>> collider_variants();

/// Builds the set that a scene describes. Colliders without an id are named after their type and position in
/// the list.
ColliderSet build_colliders(const ColliderDefs& defs);

/// Adds the row "colliders" to the table of a struct D with the member `m`.
template <class D>
TableOf<D>& add_collider_rows(TableOf<D>& table, ColliderDefs D::*m) {
  return table.variants("colliders", m, collider_variants(), {0, kMaxColliders},
                        "solids that points collide with, and containers that hold them");
}

}  // namespace truestep
