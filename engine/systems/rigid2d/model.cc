#include "engine/systems/rigid2d/model.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/math/trig.h"
#include "engine/systems/rigid2d/solver/seams.h"

namespace truestep::rigid2d {
namespace {

using flat::dot;
using flat::flatten;
using flat::norm;

constexpr double kUsualSuspension = 1;  // Hz

Rotation rotation_by(double angle) {
  const trig::SinCos t = trig::sincos(angle);
  return {t.cos, t.sin};
}

struct MakeOutlines {
  std::vector<Outline>& out;

  static std::vector<Vec2> corners(const std::vector<Vec3>& points) {
    std::vector<Vec2> p;
    for (const Vec3& x : points) p.push_back(flatten(x));
    return p;
  }
  void operator()(const CircleDef& d) const { out.push_back(flat::circle(d.radius, flatten(d.center))); }
  void operator()(const CapsuleDef& d) const {
    out.push_back(flat::capsule(flatten(d.from), flatten(d.to), d.radius));
  }
  void operator()(const BoxDef& d) const {
    out.push_back(
        flat::box(d.half_extents.x, d.half_extents.y, flatten(d.center), rotation_by(d.angle), d.radius));
  }
  void operator()(const PolygonDef& d) const { out.push_back(flat::polygon(corners(d.points), d.radius)); }
  void operator()(const ChainDef& d) const {
    using Sides = ChainDef::Sides;
    std::vector<Vec2> points = corners(d.points);
    // A link collides on its left. When a loop runs clockwise, its left is the outside.
    double twice_area = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      twice_area += flat::cross(points[i], points[(i + 1) % points.size()]);
    }
    const bool clockwise = twice_area < 0;
    if (d.sides == Sides::right || (d.sides == Sides::outside && !clockwise) ||
        (d.sides == Sides::inside && clockwise)) {
      std::reverse(points.begin(), points.end());
    }
    const auto side = d.sides == Sides::both ? Outline::Side::both : Outline::Side::left;
    for (const Outline& link : flat::chain(points, d.loop ? flat::Ends::loop : flat::Ends::open, side)) {
      out.push_back(link);
    }
  }
};

struct Builder {
  const Rigid2dDef& def;
  Model model;
  std::vector<Outline> outlines;

  void add(const BodyDef& d, Vec2 position) {
    outlines.clear();
    for (const ShapeDef& s : d.shapes) std::visit(MakeOutlines{outlines}, s);
    Body b;
    b.motion = d.motion;
    double area = 0;
    Vec2 center;
    for (const Outline& s : outlines) {
      const flat::Area a = flat::area_of(s);
      area += a.area, center = center + a.area * a.center;
    }
    center = area > 0 ? (1 / area) * center : Vec2{};
    double moment = 0;
    for (const Outline& s : outlines) {
      const flat::Area a = flat::area_of(s);
      moment += a.moment + a.area * dot(a.center - center, a.center - center);
    }
    const double density = d.mass && area > 0 ? *d.mass / area : d.density;
    b.mass = density * area, b.inertia = d.inertia.value_or(density * moment);
    b.force = flatten(d.force), b.torque = d.torque, b.force_turns = d.force_frame == BodyDef::Axes::body;
    if (d.motion == Motion::dynamic) {
      b.inverse_mass = 1 / b.mass;
      b.inverse_inertia = d.fixed_rotation ? 0 : 1 / b.inertia;
    }
    b.fixed_rotation = d.fixed_rotation;
    b.friction = d.friction.value_or(def.friction), b.restitution = d.restitution.value_or(def.restitution);
    b.rolling_resistance = d.rolling_resistance.value_or(def.rolling_resistance);
    b.surface_speed = d.surface_speed;
    b.linear_damping = d.linear_damping, b.angular_damping = d.angular_damping;
    b.gravity_scale = d.gravity_scale;
    b.sensor = d.sensor, b.bullet = d.bullet, b.can_sleep = d.can_sleep;
    b.color = d.color;
    b.asleep = d.asleep && d.motion == Motion::dynamic;
    if (d.one_way) b.one_way = true, b.one_way_direction = flat::unit(flatten(*d.one_way));
    b.group = static_cast<int32_t>(d.group);
    b.category = static_cast<uint32_t>(d.category), b.mask = static_cast<uint32_t>(d.mask);
    const Rotation q = rotation_by(d.angle);
    b.angle = d.angle;
    b.position = position + q * center;
    if (d.motion != Motion::fixed) {
      b.velocity = flatten(d.velocity), b.angular_velocity = d.angular_velocity;
    }
    b.first_shape = static_cast<uint32_t>(model.shapes.size());
    b.shapes = static_cast<uint32_t>(outlines.size());
    b.inner = outlines.empty() ? 0 : HUGE_VAL;
    for (const Outline& s : outlines) {
      model.shapes.push_back({flat::moved(s, {-center, {}}), static_cast<uint32_t>(model.bodies.size())});
      b.reach = std::max(b.reach, flat::reach(model.shapes.back().outline, {}));
      b.inner = std::min(b.inner, flat::inner_radius(s));
    }
    model.bodies.push_back(b);
  }

  void operator()(const GridDef& d) {
    const auto first = static_cast<uint32_t>(model.bodies.size());
    std::vector<int64_t> held = d.held;
    std::sort(held.begin(), held.end());
    BodyDef fixed = d.body;
    fixed.motion = Motion::fixed;
    const auto ny = static_cast<uint32_t>(d.ny);
    for (int64_t k = 0; k < d.nx; ++k) {
      for (int64_t i = 0; i < d.ny; ++i) {
        const bool hold = std::binary_search(held.begin(), held.end(), k * d.ny + i);
        add(hold ? fixed : d.body, flatten(d.origin) + Vec2{static_cast<double>(k) * d.spacing.x,
                                                            static_cast<double>(i) * d.spacing.y});
        if (!d.joined) continue;
        const auto at = static_cast<uint32_t>(model.bodies.size() - 1);
        if (at - first >= ny) hinge(at - ny, at);
        if (i > 0) hinge(at - 1, at);
      }
    }
  }
  void operator()(const PyramidDef& d) {
    for (int64_t i = 0; i < d.base; ++i) {
      for (int64_t j = 0; j < d.base - i; ++j) {
        const double x = static_cast<double>(j) - 0.5 * static_cast<double>(d.base - i - 1);
        add(d.body, flatten(d.origin) + Vec2{x * d.spacing.x, static_cast<double>(i) * d.spacing.y});
      }
    }
  }
  void operator()(const WallDef& d) {
    for (int64_t i = 0; i < d.ny; ++i) {
      for (int64_t j = 0; j < d.nx; ++j) {
        const double x = static_cast<double>(j) + (i % 2 == 1 ? 0.5 : 0);
        add(d.body, flatten(d.origin) + Vec2{x * d.spacing.x, static_cast<double>(i) * d.spacing.y});
      }
    }
  }
  void operator()(const BodyChainDef& d) {
    const Vec2 from = flatten(d.from), step = (1 / static_cast<double>(d.links)) * (flatten(d.to) - from);
    const double half = std::max(0.5 * norm(step) - d.radius, 0.01 * d.radius);
    BodyDef link = d.body;
    link.shapes = {CapsuleDef{{-half, 0, 0}, {half, 0, 0}, d.radius}};
    link.angle = trig::atan2(step.y, step.x);
    const auto first = static_cast<uint32_t>(model.bodies.size());
    const auto links = static_cast<uint32_t>(d.links);
    for (uint32_t i = 0; i < links; ++i) {
      add(link, from + (i + 0.5) * step);
      if (i > 0) hinge_at(first + i - 1, first + i, from + static_cast<double>(i) * step);
    }
    if (d.held != BodyChainDef::Held::none) hinged_to_world.push_back({first, from});
    if (d.held == BodyChainDef::Held::both) hinged_to_world.push_back({first + links - 1, flatten(d.to)});
  }

  Pose pose(uint32_t i) const { return {model.bodies[i].position, rotation_by(model.bodies[i].angle)}; }

  Joint between(JointKind kind, uint32_t a, uint32_t b, Vec2 at_a, Vec2 at_b) const {
    Joint j;
    j.kind = kind, j.a = a, j.b = b;
    j.local_a = pose(a).back(at_a), j.local_b = pose(b).back(at_b);
    j.angle = model.bodies[b].angle - model.bodies[a].angle;
    return j;
  }
  void hinge_at(uint32_t a, uint32_t b, Vec2 at) {
    model.joints.push_back(between(JointKind::revolute, a, b, at, at));
  }
  void hinge(uint32_t a, uint32_t b) {
    if (!(model.bodies[a].inverse_mass + model.bodies[b].inverse_mass > 0)) return;
    hinge_at(a, b, 0.5 * (model.bodies[a].position + model.bodies[b].position));
  }

  uint32_t body(int64_t i) const { return i < 0 ? model.world() : static_cast<uint32_t>(i); }
  Vec2 center(int64_t i) const { return model.bodies[body(i)].position; }
  /// Midway between the bodies; at the centre of the other one if one of them is the world.
  Vec2 anchor(const JointDef& d) const {
    if (d.anchor) return flatten(*d.anchor);
    if (d.a < 0 || d.b < 0) return center(d.a < 0 ? d.b : d.a);
    return 0.5 * (center(d.a) + center(d.b));
  }
  /// Of a joint between two points: the bodies' centres unless given.
  template <class D>
  std::pair<Vec2, Vec2> ends(const D& d) const {
    return {d.anchor ? flatten(*d.anchor) : center(d.a), d.anchor_b ? flatten(*d.anchor_b) : center(d.b)};
  }
  Joint common(JointKind kind, const JointDef& d, std::pair<Vec2, Vec2> at) const {
    Joint j = between(kind, body(d.a), body(d.b), at.first, at.second);
    j.break_force = d.break_force.value_or(0), j.break_torque = d.break_torque.value_or(0);
    j.collide = d.collide;
    return j;
  }
  Joint common(JointKind kind, const JointDef& d) const { return common(kind, d, {anchor(d), anchor(d)}); }
  static void drive(Joint& j, const Drive& d) {
    j.has_target = d.motor_target.has_value(), j.has_motor = d.motor_speed || d.motor_target;
    j.motor_speed = d.motor_speed.value_or(0), j.motor_target = d.motor_target.value_or(0);
    j.motor_rate = d.motor_rate;
    j.max_motor = d.max_motor.value_or(HUGE_VAL);
    j.has_lower = d.lower.has_value(), j.lower = d.lower.value_or(0);
    j.has_upper = d.upper.has_value(), j.upper = d.upper.value_or(0);
    spring(j, d), j.rest = d.rest;
  }
  /// By its frequency or by its stiffness and damping.
  template <class D>
  static void spring(Joint& j, const D& d) {
    j.has_spring = d.hertz || d.stiffness || d.damping;
    j.hertz = d.hertz.value_or(0), j.damping_ratio = d.damping_ratio;
    j.stiffness = d.stiffness.value_or(0), j.damping = d.damping.value_or(0);
  }
  void set_axis(Joint& j, const Vec3& axis) const { j.axis = pose(j.a).q.back(flat::unit(flatten(axis))); }

  Joint operator()(const RevoluteDef& d) const {
    Joint j = common(JointKind::revolute, d);
    drive(j, d);
    return j;
  }
  Joint operator()(const PrismaticDef& d) const {
    Joint j = common(JointKind::prismatic, d);
    drive(j, d);
    set_axis(j, d.axis);
    return j;
  }
  Joint operator()(const WheelDef& d) const {
    Joint j = common(JointKind::wheel, d);
    drive(j, d);
    if (!j.has_spring) j.has_spring = true, j.hertz = kUsualSuspension;
    if (d.hertz == 0.0) j.has_spring = false;
    set_axis(j, d.axis);
    return j;
  }
  Joint operator()(const DistanceDef& d) const {
    const auto [at_a, at_b] = ends(d);
    Joint j = common(JointKind::distance, d, {at_a, at_b});
    const double now = norm(at_b - at_a);
    j.rest = j.length = d.length.value_or(now);
    j.has_spring = d.hertz.has_value(), j.hertz = d.hertz.value_or(0), j.damping_ratio = d.damping_ratio;
    j.has_lower = d.minimum.has_value(), j.lower = d.minimum.value_or(0);
    j.has_upper = d.maximum.has_value(), j.upper = d.maximum.value_or(0);
    return j;
  }
  Joint operator()(const SpringDef& d) const {
    const auto [at_a, at_b] = ends(d);
    Joint j = common(JointKind::distance, d, {at_a, at_b});
    j.rest = j.length = d.length.value_or(norm(at_b - at_a));
    spring(j, d);
    return j;
  }
  Joint operator()(const WeldDef& d) const {
    Joint j = common(JointKind::weld, d);
    j.has_spring = d.hertz.has_value(), j.hertz = d.hertz.value_or(0), j.damping_ratio = d.damping_ratio;
    return j;
  }
  Joint operator()(const MotorDef& d) const {
    const auto b = d.b < 0 ? model.world() : static_cast<uint32_t>(d.b);
    Joint j = common(JointKind::motor, d);
    j.local_b = {}, j.local_a = pose(j.a).back(model.bodies[b].position);
    if (!d.velocity) j.local_a = j.local_a + flatten(d.move);
    if (!d.angular_velocity) j.angle += d.turn, j.turn = d.turn;
    j.at_velocity = d.velocity.has_value(), j.move = flatten(d.velocity.value_or(d.move));
    j.at_spin = d.angular_velocity.has_value(), j.spin = d.angular_velocity.value_or(0);
    j.max_force = d.max_force, j.max_torque = d.max_torque, j.motor_rate = d.rate;
    return j;
  }
  Joint operator()(const MouseDef& d) const {
    Joint j = common(JointKind::mouse, d);
    j.ground_a = flatten(d.target), j.hertz = d.hertz, j.damping_ratio = d.damping_ratio;
    j.max_force = d.max_force.value_or(HUGE_VAL);
    return j;
  }
  Joint operator()(const GearDef& d) const {
    Joint j = common(JointKind::gear, d);
    j.ratio = d.ratio;
    j.angle = model.bodies[j.a].angle + d.ratio * model.bodies[j.b].angle;
    return j;
  }
  Joint operator()(const PulleyDef& d) const {
    const auto [at_a, at_b] = ends(d);
    Joint j = common(JointKind::pulley, d, {at_a, at_b});
    j.ratio = d.ratio, j.ground_a = flatten(d.ground_a), j.ground_b = flatten(d.ground_b);
    j.length = norm(at_a - j.ground_a) + d.ratio * norm(at_b - j.ground_b);
    return j;
  }

  std::vector<std::pair<uint32_t, Vec2>> hinged_to_world;
};

/// Twice the median inner radius of the dynamic bodies: the thickness of a typical body.
double typical_size(const Model& model) {
  std::vector<double> inner;
  for (const Body& b : model.bodies) {
    if (b.motion == Motion::dynamic && b.inner > 0) inner.push_back(b.inner);
  }
  if (inner.empty()) return 1;
  const auto middle = inner.begin() + static_cast<std::ptrdiff_t>(inner.size() / 2);
  std::nth_element(inner.begin(), middle, inner.end());
  return 2 * *middle;
}

void gather_hot_parts(Model& m) {
  for (const Body& b : m.bodies) {
    m.light.push_back({.reach = b.reach,
                       .inner = b.inner,
                       .mass = b.mass,
                       .category = b.category,
                       .mask = b.mask,
                       .group = b.group,
                       .motion = b.motion,
                       .sensor = b.sensor,
                       .bullet = b.bullet,
                       .one_way = b.one_way,
                       .can_sleep = b.can_sleep});
    m.dynamics.push_back(
        {b.inverse_mass, b.inverse_inertia, b.linear_damping, b.angular_damping, b.gravity_scale});
    m.surfaces.push_back({b.friction, b.restitution, b.rolling_resistance, b.surface_speed});
    if (b.motion == Motion::dynamic && (flat::dot(b.force, b.force) > 0 || b.torque != 0)) {
      m.forced.push_back(static_cast<uint32_t>(m.light.size() - 1));
    }
  }
  for (const Shape& s : m.shapes) {
    m.body_of.push_back(s.body), m.radius.push_back(s.outline.radius);
  }
  for (uint32_t i = 0; i < m.joints.size(); ++i) {
    Joint& j = m.joints[i];
    if (j.has_motor || j.kind == JointKind::motor || j.kind == JointKind::mouse) {
      j.motor_row = static_cast<uint32_t>(m.motors.size()), m.motors.push_back(i);
    }
    m.may_break = m.may_break || j.may_break();
    for (const auto& [one, other] : {std::pair{j.a, j.b}, {j.b, j.a}}) {
      const bool firm = !j.may_break() && j.kind != JointKind::mouse;
      m.light[one].jointed = true;
      if (firm && m.light[other].motion != Motion::dynamic) m.light[one].hung = true;
    }
    if (j.plain()) {
      m.hinges.push_back({i, j.a, j.b, j.local_a, j.local_b});
    } else {
      m.others.push_back(i);
    }
  }
}

}  // namespace

Model build_model(const Rigid2dDef& def) {
  Builder build{def, {}, {}, {}};
  for (const BodyDef& b : def.bodies) build.add(b, flatten(b.position));
  for (const GeneratorDef& g : def.generators) std::visit([&](const auto& d) { build(d); }, g);
  Model& m = build.model;
  m.bodies.push_back({});
  for (const auto& [body, at] : build.hinged_to_world) build.hinge_at(m.world(), body, at);
  for (const AnyJointDef& j : def.joints) {
    const std::string& id = std::visit([](const auto& d) -> const std::string& { return d.id; }, j);
    if (!id.empty()) m.names.push_back({static_cast<uint32_t>(m.joints.size()), id});
    m.joints.push_back(std::visit([&](const auto& d) { return build(d); }, j));
  }
  for (size_t i = 0; i < m.joints.size(); ++i) {
    const Joint& j = m.joints[i];
    if (m.bodies[j.a].inverse_mass + m.bodies[j.b].inverse_mass > 0) continue;
    throw Error("scene_invalid", "a joint needs a dynamic body",
                {"/joints", "no_dynamic_body", "a joint needs a dynamic body", "", "", "", ""});
  }
  for (Joint& j : m.joints) stiffen_by_frequency(j, m.bodies[j.a], m.bodies[j.b]);
  for (const Joint& j : m.joints) {
    if (!j.collide) m.not_touching.push_back(uint64_t{std::min(j.a, j.b)} << 32 | std::max(j.a, j.b));
  }
  std::sort(m.not_touching.begin(), m.not_touching.end());
  m.not_touching.erase(std::unique(m.not_touching.begin(), m.not_touching.end()), m.not_touching.end());
  m.size = typical_size(m);
  m.margin = def.contact_margin.value_or(0.02 * m.size);
  gather_hot_parts(m);
  for (const Light& b : m.light) {
    if (b.motion == Motion::dynamic && !b.sensor && b.inner > 0) m.thinnest = std::min(m.thinnest, b.inner);
  }
  m.seams = has_seams(m);
  return std::move(build.model);
}

}  // namespace truestep::rigid2d
