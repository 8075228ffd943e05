#include "engine/systems/rigid3d/bodies.h"

#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/random.h"
#include "engine/geometry/compound.h"
#include "engine/math/trig.h"

namespace truestep::rigid3d {
namespace {

Quat conjugate(const Quat& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

Quat turned(const Vec3& axis, double angle) {
  if (angle == 0) return {};
  const auto [s, c] = trig::sincos(0.5 * angle);
  const Vec3 a = normalized(axis, {0, 1, 0}) * s;
  return normalized(Quat{c, a.x, a.y, a.z});
}

Quat orientation(const BodyDef& d) {
  const auto& q = d.orientation;
  return q.size() == 4 ? normalized(Quat{q[0], q[1], q[2], q[3]}) : turned(d.axis, d.angle);
}

Solid part_solid(const AnyPartDef& d) {
  struct Make {
    Solid operator()(const SpherePartDef& p) { return sphere_solid(p.radius); }
    Solid operator()(const BoxPartDef& p) { return box_solid(p.half_extents); }
    Solid operator()(const CapsulePartDef& p) { return capsule_solid(p.radius, p.half_length); }
    Solid operator()(const CylinderPartDef& p) { return cylinder_solid(p.radius, p.half_length); }
    Solid operator()(const HullPartDef& p) { return hull_solid(p.points); }
  };
  return std::visit(Make{}, d);
}

// Distances are compared by their squares, which underflow or overflow outside this range.
constexpr double kSmallest = 1e-150, kLargest = 1e150;  // m
/// Radius of the contact patch of balls and capsule ends, as a fraction of theirs: the value for hard balls
/// of a centimetre to a metre under their own weight (Hertz).
constexpr double kPatchShare = 0.01;

std::vector<uint32_t> checked_triangles(const MeshBodyDef& d) {
  if (d.triangles.size() % 3 != 0) throw Error("bad_mesh", "triangles need three indices each");
  std::vector<uint32_t> out;
  for (const int64_t i : d.triangles) {
    if (i < 0 || static_cast<size_t>(i) >= d.vertices.size()) {
      throw Error("bad_mesh", "a triangle refers to vertex " + std::to_string(i) + ", which does not exist");
    }
    out.push_back(static_cast<uint32_t>(i));
  }
  return out;
}

/// Builds the scene's shape in the body's frame.
struct MakeSolid {
  Transform to_body;  // from the scene's frame
  Pose to_body_pose;

  std::vector<Vec3> moved(const std::vector<Vec3>& points) const {
    std::vector<Vec3> out;
    for (const Vec3& p : points) out.push_back(to_body.point(p));
    return out;
  }
  Solid operator()(const SphereBodyDef& d) const { return sphere_solid(d.radius); }
  Solid operator()(const BoxBodyDef& d) const { return box_solid(d.half_extents); }
  Solid operator()(const CapsuleBodyDef& d) const { return capsule_solid(d.radius, d.half_length); }
  Solid operator()(const CylinderBodyDef& d) const { return cylinder_solid(d.radius, d.half_length); }
  Solid operator()(const HullBodyDef& d) const { return hull_solid(moved(d.points)); }
  Solid operator()(const MeshBodyDef& d) const { return mesh_solid(moved(d.vertices), checked_triangles(d)); }
  Solid operator()(const HeightFieldBodyDef& d) const {
    const auto nx = static_cast<size_t>(d.count[0]), nz = static_cast<size_t>(d.count[1]);
    if (d.heights.size() != nx * nz) throw Error("bad_heights", "there must be count[0] x count[1] heights");
    return height_field_solid(nx, nz, d.spacing, d.heights);
  }
  Solid operator()(const PlaneBodyDef& d) const { return plane_solid(d.normal); }
  Solid operator()(const CompoundBodyDef& d) const { return compound_solid(parts(d)); }
  std::vector<SolidPart> parts(const CompoundBodyDef& d) const {
    std::vector<SolidPart> parts;
    for (const AnyPartDef& p : d.parts) {
      const PartDef& place = std::visit([](const auto& x) -> const PartDef& { return x; }, p);
      parts.push_back({part_solid(p),
                       {to_body.point(place.position),
                        normalized(to_body_pose.orientation * turned(place.axis, place.angle))}});
    }
    return parts;
  }
};

BodyKind build_kind(const AnyBodyDef& any, const Rigid3dDef& def) {
  const BodyDef& d = common(any);
  BodyKind k;
  k.id = d.id, k.motion = d.motion, k.sensor = d.sensor, k.color = d.color;
  k.friction = d.friction.value_or(def.friction);
  k.restitution = d.restitution.value_or(def.restitution);
  k.rolling = d.rolling_resistance.value_or(def.rolling_resistance);
  k.spinning = d.spinning_resistance ? d.spinning_resistance : def.spinning_resistance;
  k.linear_damping = d.linear_damping, k.angular_damping = d.angular_damping;
  k.gravity_scale = d.gravity_scale;
  k.asleep = d.asleep && k.motion == BodyDef::Motion::dynamic, k.can_sleep = d.can_sleep;
  k.fixed_rotation = d.fixed_rotation && k.motion == BodyDef::Motion::dynamic;
  k.group = static_cast<int32_t>(d.group);
  k.category = static_cast<uint32_t>(d.category), k.mask = static_cast<uint32_t>(d.mask);
  const auto place = [&](const MakeSolid& make) {
    k.solid = std::visit(make, any);
    if (const auto* compound = std::get_if<CompoundBodyDef>(&any)) k.parts = make.parts(*compound);
  };
  place({});
  if (k.motion == BodyDef::Motion::dynamic) {
    MassProperties m = mass_properties(k.solid, d.density);
    if (d.mass) m.inertia = m.inertia * (*d.mass / m.mass), m.mass = *d.mass;
    if (!d.inertia.empty()) m.inertia = inertia_of(d.inertia);
    const PrincipalAxes axes = principal_axes(m.inertia);
    k.mass = m.mass, k.moments = axes.moments;
    k.force = d.force, k.torque = d.torque, k.force_turns = d.force_frame == BodyDef::Axes::body;
    if (k.force_turns) {
      const Rotation to_body = rotation(conjugate(axes.axes));
      k.force = to_body.apply(k.force), k.torque = to_body.apply(k.torque);
    }
    if (m.center != Vec3{} || axes.axes != Quat{}) {
      k.center = m.center, k.axes = axes.axes;
      const Pose from{k.center, k.axes};
      const Quat back = conjugate(k.axes);
      k.solid =
          std::visit(MakeSolid{inverse(transform_of(from)), {rotation(back).apply(-k.center), back}}, any);
    }
  }
  k.surface_velocity = rotation(conjugate(k.axes)).apply(d.surface_velocity);
  if (d.one_way) {
    k.one_way = true;
    k.one_way_direction = rotation(conjugate(k.axes)).apply(normalized(*d.one_way, {0, 1, 0}));
  }
  k.reach = bounding_radius(k.solid), k.inner = inner_radius(k.solid);
  const bool sized = is_convex(k.solid.kind) || k.solid.kind == SolidKind::compound;
  if (sized && !(k.inner >= kSmallest && k.reach <= kLargest))
    throw Error("bad_solid", "the size of a body must lie between 1e-150 and 1e150 m");
  if (k.solid.kind == SolidKind::sphere || k.solid.kind == SolidKind::capsule) {
    k.patch = kPatchShare * k.solid.size.x;
  }
  k.turned_round = k.solid.kind == SolidKind::cylinder;
  if (k.solid.kind == SolidKind::compound) {
    for (const Compound::Part& p : k.solid.compound->parts()) {
      k.turned_round = k.turned_round || p.solid.kind == SolidKind::cylinder;
    }
  }
  return k;
}

Quat random_orientation(const std::array<double, 4>& u) {
  // Shoemake 1992: uniform over the unit quaternions.
  const auto [s1, c1] = trig::sincos(6.283185307179586 * u[1]);
  const auto [s2, c2] = trig::sincos(6.283185307179586 * u[2]);
  const double a = std::sqrt(1 - u[0]), b = std::sqrt(u[0]);
  return normalized(Quat{b * c2, a * s1, a * c1, b * s2});
}

/// Positions of the copies relative to the body, in order.
void add_copies(const BodyKind& kind, const BodyDef& d, uint32_t index, uint64_t seed,
                std::vector<BodyStart>& out) {
  const Quat base = orientation(d);
  const auto add = [&](const Vec3& at, const Quat& q) {
    out.push_back({index, kind.body_pose({at, q}), d.velocity, d.angular_velocity, kind.asleep});
  };
  if (!d.copies) return add(d.position, base);
  const CopiesDef& c = *d.copies;
  uint64_t number = 0;
  const auto place = [&](const Vec3& offset, const Quat& q) {
    const auto u = uniform4(seed, 2 * index, number), r = uniform4(seed, 2 * index + 1, number);
    ++number;
    const Vec3 shake{(2 * u[0] - 1) * c.jitter, (2 * u[1] - 1) * c.jitter, (2 * u[2] - 1) * c.jitter};
    add(d.position + offset + shake, c.turn == CopiesDef::Turn::random ? random_orientation(r) : q);
  };
  const auto count = [&c](size_t k) { return k < c.count.size() ? c.count[k] : int64_t{1}; };
  const auto centered = [](int64_t i, int64_t n) {
    return static_cast<double>(i) - 0.5 * static_cast<double>(n - 1);
  };
  const Vec3& s = c.spacing;
  if (c.layout == CopiesDef::Layout::circle) {
    for (int64_t i = 0; i < count(0); ++i) {
      const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(count(0));
      const auto [sin, cos] = trig::sincos(angle);
      place({c.radius * cos, 0, -c.radius * sin},
            c.turn == CopiesDef::Turn::outward ? turned({0, 1, 0}, angle) * base : base);
    }
    return;
  }
  const bool rows = c.layout != CopiesDef::Layout::grid;
  const int64_t layers = rows ? count(0) : count(1);
  for (int64_t k = 0; k < layers; ++k) {
    const int64_t nx = rows ? count(0) - k : count(0);
    const int64_t nz = c.layout == CopiesDef::Layout::pyramid ? nx : rows ? 1 : count(2);
    for (int64_t i = 0; i < nx; ++i) {
      for (int64_t j = 0; j < nz; ++j) {
        place({centered(i, nx) * s.x, static_cast<double>(k) * s.y, centered(j, nz) * s.z}, base);
      }
    }
  }
}

bool is_surface(const BodyKind& k) {
  return k.solid.kind == SolidKind::mesh || k.solid.kind == SolidKind::height_field;
}

/// Reports pairs of the scene's kinds that would fall through each other.
void refuse_surfaces_that_meet(const BodyList& list, std::vector<Issue>& issues) {
  std::vector<size_t> copies(list.kinds.size(), 0);
  for (const BodyStart& b : list.starts) ++copies[b.kind];
  for (size_t i = 0; i < list.kinds.size(); ++i) {
    const BodyKind& a = list.kinds[i];
    if (!is_surface(a) || !a.moved_by_forces() || a.sensor) continue;
    for (size_t j = 0; j < list.kinds.size(); ++j) {
      const BodyKind& b = list.kinds[j];
      const bool other = i != j ? !b.moved_by_forces() || i < j : copies[i] > 1;
      if (!falls_through(a, b) || !other) continue;
      issues.push_back({"/bodies/" + std::to_string(i), "surfaces_do_not_meet",
                        "a dynamic mesh collides with planes and convex shapes, but not with other meshes "
                        "and height fields such as body " +
                            std::to_string(j) +
                            ": it would fall through. Use a hull or a compound of "
                            "hulls, or exclude the pair by group or mask",
                        "\"mesh\"", "hull, compound, box ...", "", ""});
      break;
    }
  }
}

}  // namespace

bool filter_allows(const BodyKind& a, const BodyKind& b) {
  if (a.group != 0 && a.group == b.group) return a.group > 0;
  return (a.category & b.mask) && (b.category & a.mask);
}

bool falls_through(const BodyKind& a, const BodyKind& b) {
  const bool asked = filter_allows(a, b) && !a.sensor && !b.sensor;
  return is_surface(a) && is_surface(b) && asked && (a.moved_by_forces() || b.moved_by_forces());
}

Pose BodyKind::body_pose(const Pose& shape) const {
  return {shape.position + rotation(shape.orientation).apply(center), normalized(shape.orientation * axes)};
}
Pose BodyKind::shape_pose(const Pose& body) const {
  const Quat q = normalized(body.orientation * conjugate(axes));
  return {body.position - rotation(q).apply(center), q};
}

ScaledBody scaled_body(const BodyKind& kind, const Rotation& R) {
  ScaledBody out;
  const Vec3 resistance = kind.resistance();
  const double moments[3] = {resistance.x, resistance.y, resistance.z};
  for (int row = 0; row < 3; ++row) {
    const Vec3 e = axis(R, row) / std::sqrt(moments[row]);
    out.turn[3 * row] = e.x, out.turn[3 * row + 1] = e.y, out.turn[3 * row + 2] = e.z;
  }
  out.root = 1 / std::sqrt(kind.mass);
  return out;
}

BodyList build_bodies(const Rigid3dDef& def, uint64_t seed) {
  BodyList list;
  std::vector<Issue> issues;
  for (size_t i = 0; i < def.bodies.size(); ++i) {
    try {
      list.kinds.push_back(build_kind(def.bodies[i], def));
    } catch (const Error& e) {
      issues.push_back({"/bodies/" + std::to_string(i), e.code(), e.what(), "", "", "", ""});
      continue;
    }
    if (!issues.empty()) continue;
    const BodyKind& k = list.kinds.back();
    if (k.moved_by_forces() && !k.sensor) list.thinnest = std::min(list.thinnest, k.inner);
    add_copies(k, common(def.bodies[i]), static_cast<uint32_t>(i), seed, list.starts);
  }
  if (issues.empty()) refuse_surfaces_that_meet(list, issues);
  if (!issues.empty()) throw Error("scene_invalid", "a body's shape is no valid solid", std::move(issues));
  list.seams = has_seams(list);
  return list;
}

}  // namespace truestep::rigid3d
