#include "engine/collision/points/solid_collider.h"

#include "engine/collision/drawn_mesh.h"
#include "engine/geometry/make/enclosure.h"
#include "engine/math/trig.h"

namespace truestep {
namespace {

constexpr double kFullTurn = 6.283185307179586;

SolidCollider build_solid(const MeshColliderDef& d, double) {
  SolidCollider c;
  c.solid = mesh_solid(d.vertices, {d.triangles.begin(), d.triangles.end()});
  c.side = d.container ? PointSide::inside : PointSide::outside;
  c.start = {d.center, turned_by(d.axis, d.angle)};
  c.drawn = drawn_shape(c.solid, c.start);
  return c;
}

SolidCollider build_solid(const HeightFieldColliderDef& d, double around) {
  SolidCollider c;
  const auto nx = static_cast<size_t>(d.count[0]), nz = static_cast<size_t>(d.count[1]);
  EnclosingMesh ground = ground_block(nx, nz, d.spacing, d.heights, around, around);
  c.solid = mesh_solid(std::move(ground.vertices), std::move(ground.triangles));
  c.start.position = d.center;
  c.drawn = drawn_shape(height_field_solid(nx, nz, d.spacing, d.heights), c.start);
  return c;
}

}  // namespace

Vec3 SolidCollider::velocity_at(const Vec3& x, double t) const {
  if (motion.at_rest()) return {};
  const ShapeMotion& m = motion;
  const double turn = std::fmod(m.frequency * t, 1.0) * kFullTurn;
  const Vec3 swing = m.amplitude * (kFullTurn * m.frequency * trig::cos(turn + m.phase));
  return m.velocity + swing + cross(m.spin, x - moved(start, m, t).position);
}

std::vector<SolidCollider> build_solid_colliders(const AnyColliderDefs& defs, double around) {
  std::vector<SolidCollider> out;
  const auto add = [&](const auto& d, size_t i) {
    if constexpr (requires { build_solid(d, around); }) {
      const Collider common = common_collider(d);
      SolidCollider c = build_solid(d, around);
      c.id = collider_id(common.id, defs[i].index(), i), c.index = i;
      c.motion = common.motion;
      out.push_back(std::move(c));
    }
  };
  for (size_t i = 0; i < defs.size(); ++i) std::visit([&](const auto& d) { add(d, i); }, defs[i]);
  return out;
}

DrawnShape SolidCollider::drawn_at(double t) const {
  DrawnShape out = drawn;
  const Pose pose = moved(start, motion, t);
  const Quat& q = pose.orientation;
  out.position = pose.position, out.orientation = {q.w, q.x, q.y, q.z}, out.id = id;
  out.container = side == PointSide::inside;
  return out;
}

}  // namespace truestep
