#include "engine/collision/points/collider_def.h"

#include "engine/math/trig.h"

namespace truestep {

const DefTable& collider_motion_table() {
  static const DefTable t =
      TableOf<MotionDef>(
          "prescribed motion: position = start + velocity t + amplitude (sin(2 pi frequency t + "
          "phase) - sin(phase)), turned by spin t")
          .vector("velocity", &MotionDef::velocity, "m/s", any(), "steady velocity")
          .vector("amplitude", &MotionDef::amplitude, "m", any(),
                  "amplitude of the oscillation about the start")
          .number("frequency", &MotionDef::frequency, "Hz", at_least(0), "frequency of the oscillation")
          .number("phase", &MotionDef::phase, "rad", any(), "phase of the oscillation at t = 0")
          .vector("spin", &MotionDef::spin, "rad/s", any(), "angular velocity about the shape's origin")
          .build();
  return t;
}

Collider common_collider(const ColliderCommonDef& d) {
  Collider c;
  c.id = d.id;
  c.surface = {d.restitution, d.friction, d.rest_speed};
  if (d.motion) {
    c.motion = {d.motion->velocity, d.motion->amplitude, d.motion->frequency, d.motion->phase,
                d.motion->spin};
  }
  return c;
}

std::string collider_id(const std::string& own, size_t kind, size_t index) {
  static constexpr const char* kNames[] = {"plane", "box", "sphere", "capsule", "mesh", "height_field"};
  return own.empty() ? kNames[kind] + std::to_string(index) : own;
}

Quat turned_by(const Vec3& axis, double angle) {
  const Vec3 half = normalized(axis, {0, 1, 0}) * trig::sin(0.5 * angle);
  return normalized(Quat{trig::cos(0.5 * angle), half.x, half.y, half.z});
}

namespace {

const DefTable& plane_table() {
  static const DefTable t = [] {
    using D = PlaneColliderDef;
    TableOf<D> table("half space that points stay above");
    add_collider_common(
        table.vector("point", &D::point, "m", any(), "a point of the plane")
            .vector("normal", &D::normal, "1", any(), "pointing to the free side; any length"));
    return table
        .check([](const D& d, const DefTable::Report& report) {
          if (!(norm(d.normal) > 0)) report("/normal", "the normal must not be zero");
        })
        .build();
  }();
  return t;
}

const DefTable& box_table() {
  static const DefTable t = [] {
    using D = BoxColliderDef;
    TableOf<D> table("box, rotated by an angle about an axis");
    table.vector("center", &D::center, "m", any(), "centre at t = 0")
        .vector("half_extents", &D::half_extents, "m", above(0), "half of each edge")
        .vector("axis", &D::axis, "1", any(), "axis of its rotation; any length")
        .number("angle", &D::angle, "rad", any(), "angle of its rotation");
    return add_collider_common(add_collider_container(table)).build();
  }();
  return t;
}

const DefTable& sphere_table() {
  static const DefTable t = [] {
    using D = SphereColliderDef;
    TableOf<D> table("ball");
    table.vector("center", &D::center, "m", any(), "centre at t = 0")
        .number("radius", &D::radius, "m", above(0), "radius");
    return add_collider_common(add_collider_container(table)).build();
  }();
  return t;
}

const DefTable& capsule_table() {
  static const DefTable t = [] {
    using D = CapsuleColliderDef;
    TableOf<D> table("cylinder with round ends");
    table.vector("from", &D::from, "m", any(), "one end of its axis at t = 0")
        .vector("to", &D::to, "m", any(), "the other end")
        .number("radius", &D::radius, "m", above(0), "radius of the cylinder and of its ends");
    return add_collider_common(add_collider_container(table)).build();
  }();
  return t;
}

PointSide side(bool container) {
  return container ? PointSide::inside : PointSide::outside;
}

Collider build(const PlaneColliderDef& d) {
  Collider c = common_collider(d);
  c.shape = {ShapeKind::plane, PointSide::outside, normalized(d.normal, {0, 1, 0})};
  c.start.position = d.point;
  return c;
}

Collider build(const BoxColliderDef& d) {
  Collider c = common_collider(d);
  c.shape = {ShapeKind::box, side(d.container), d.half_extents};
  c.start.position = d.center;
  if (d.angle != 0) c.start.orientation = turned_by(d.axis, d.angle);
  return c;
}

Collider build(const SphereColliderDef& d) {
  Collider c = common_collider(d);
  c.shape = {ShapeKind::sphere, side(d.container), {d.radius, 0, 0}};
  c.start.position = d.center;
  return c;
}

Collider build(const CapsuleColliderDef& d) {
  Collider c = common_collider(d);
  const Vec3 axis = d.to - d.from;
  c.shape = {ShapeKind::capsule, side(d.container), {d.radius, 0.5 * norm(axis), 0}};
  c.start.position = (d.from + d.to) * 0.5;
  c.start.orientation = rotation_between({0, 1, 0}, normalized(axis, {0, 1, 0}));
  return c;
}

}  // namespace

const DefTable& collider_surface_table() {
  static const DefTable t =
      TableOf<ColliderCommonDef>("a collider")
          .text("id", &ColliderCommonDef::id,
                "name for set_parameter (<id>.restitution, <id>.friction) and pictures")
          .number("friction", &ColliderCommonDef::friction, "1", at_least(0), "Coulomb's coefficient")
          .number("restitution", &ColliderCommonDef::restitution, "1", between(0, 1),
                  "fraction of the normal speed kept in a bounce")
          .number("rest_speed", &ColliderCommonDef::rest_speed, "m/s", at_least(0),
                  "slower approaches do not bounce")
          .build();
  return t;
}

ColliderVariants collider_variants() {
  return {{"plane", &plane_table()},
          {"box", &box_table()},
          {"sphere", &sphere_table()},
          {"capsule", &capsule_table()}};
}

namespace {

template <class Defs>
ColliderSet build_set(const Defs& defs) {
  ColliderSet set;
  const auto add = [&](const auto& d, size_t i) {
    if constexpr (requires { build(d); }) {
      Collider c = build(d);
      c.id = collider_id(c.id, defs[i].index(), i);
      set.add(std::move(c));
    }
  };
  for (size_t i = 0; i < defs.size(); ++i) std::visit([&](const auto& d) { add(d, i); }, defs[i]);
  return set;
}

}  // namespace

ColliderSet build_colliders(const ColliderDefs& defs) {
  return build_set(defs);
}
ColliderSet build_colliders_but_solids(const AnyColliderDefs& defs) {
  return build_set(defs);
}

}  // namespace truestep
