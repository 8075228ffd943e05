// How a scene describes colliders: "colliders": [{"type": "plane" | "box" | "sphere" | "capsule", ...}],
// shared by every system made of points. Systems that need no more of a collider than its distance also take
// meshes and height fields (solid_collider.h).
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

const DefTable& collider_motion_table();

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

struct MeshColliderDef : ColliderCommonDef {
  std::vector<Vec3> vertices;
  std::vector<int64_t> triangles;
  Vec3 center, axis{0, 1, 0};
  double angle = 0;
  bool container = false;
};
struct HeightFieldColliderDef : ColliderCommonDef {
  std::vector<int64_t> count;
  double spacing = 1;
  std::vector<double> heights;
  Vec3 center;
};

using ColliderDef = std::variant<PlaneColliderDef, BoxColliderDef, SphereColliderDef, CapsuleColliderDef>;
using ColliderDefs = std::vector<ColliderDef>;
/// With those that have no other description than their surface.
using AnyColliderDef = std::variant<PlaneColliderDef, BoxColliderDef, SphereColliderDef, CapsuleColliderDef,
                                    MeshColliderDef, HeightFieldColliderDef>;
using AnyColliderDefs = std::vector<AnyColliderDef>;

using ColliderVariants = std::vector<NamedTable>;
/// Names and tables of the alternatives in the order of ColliderDef, for TableOf::variants.
ColliderVariants collider_variants();
/// The same of AnyColliderDef (solid_collider_def.cc).
ColliderVariants any_collider_variants();

/// A collider with what all alternatives have in common, without a shape.
Collider common_collider(const ColliderCommonDef& def);
/// The id of collider `index` of a list, whose alternative is `kind`: its own, or its type and position.
std::string collider_id(const std::string& own, size_t kind, size_t index);
/// Orientation of an angle (rad) about an axis of any length.
Quat turned_by(const Vec3& axis, double angle);

/// Builds the set that a scene describes. Colliders without an id are named after their type and position in
/// the list.
ColliderSet build_colliders(const ColliderDefs& defs);
/// The same without the meshes and height fields of a list, which build_solid_colliders builds.
ColliderSet build_colliders_but_solids(const AnyColliderDefs& defs);

/// The rows of ColliderCommonDef but its motion.
const DefTable& collider_surface_table();
/// Adds them to the table of an alternative D.
template <class D>
TableOf<D>& add_collider_surface(TableOf<D>& t) {
  return t.template base<ColliderCommonDef>(collider_surface_table());
}
/// And its motion.
template <class D>
TableOf<D>& add_collider_common(TableOf<D>& t) {
  std::optional<MotionDef> D::*motion = &ColliderCommonDef::motion;
  return add_collider_surface(t).object("motion", motion, collider_motion_table(),
                                        "how it moves; absent: at rest");
}
template <class D>
TableOf<D>& add_collider_container(TableOf<D>& t) {
  return t.boolean("container", &D::container, "points stay inside instead of outside");
}

/// Adds the row "colliders" to the table of a struct D with the member `m`.
template <class D>
TableOf<D>& add_collider_rows(TableOf<D>& table, ColliderDefs D::*m) {
  return table.variants("colliders", m, collider_variants(), {0, kMaxColliders},
                        "solids that points collide with, and containers that hold them");
}
template <class D>
TableOf<D>& add_collider_rows(TableOf<D>& table, AnyColliderDefs D::*m) {
  return table.variants("colliders", m, any_collider_variants(), {0, kMaxColliders},
                        "solids that points collide with, and containers that hold them");
}

}  // namespace truestep
