// What rigid bodies in the plane give out.
#include <algorithm>
#include <cmath>

#include "engine/collision/flat/distance.h"
#include "engine/core/outputs/outputs_of.h"
#include "engine/systems/rigid2d/joint_energy.h"
#include "engine/systems/rigid2d/joint_loads.h"
#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep::rigid2d {

struct Rigid2d::Whole {
  double kinetic = 0, rotation = 0, potential = 0, total = 0, px = 0, py = 0, spin = 0, fastest = 0;
  double count = 0, awake = 0, substeps = 0, contacts = 0, penetration = 0;
  std::optional<double> sensed = {};
};
struct Rigid2d::AllJoints {
  double gap = 0, broken = 0, tilt = 0, force = 0, torque = 0;
};
struct Rigid2d::OneJoint {
  double force = 0, torque = 0, broken = 0;
  std::optional<double> position = {}, angle = {}, length = {};
};

namespace {

double deepest(const Model& model, const State& s) {
  double depth = 0;
  flat::Contact c;
  for (const uint64_t key : s.span<uint64_t>(columns::contact_key)) {
    const Shape &a = model.shapes[key >> 32], &b = model.shapes[static_cast<uint32_t>(key)];
    const Pose seen = pose_of(s, a.body).to(pose_of(s, b.body));
    if (!flat::touch(a.outline, b.outline, seen, 0, c)) continue;
    for (uint32_t k = 0; k < c.points; ++k) depth = std::max(depth, -c.point[k].separation);
  }
  return depth;
}

void orientations(const State& s, ShownRows rows, double* out) {
  std::fill_n(out, 4 * rows.count, 0.0);
  for (size_t i = 0; i < rows.count; ++i) {
    const trig::SinCos half = trig::sincos(0.5 * s.f64(columns::angle)[i]);
    out[4 * i] = half.cos, out[4 * i + 3] = half.sin;
  }
}

std::span<const double, 6> impulses_of(const State& s, size_t joint) {
  return std::span<const double, 6>(s.f64(columns::joint_impulse).data() + 6 * joint, 6);
}

/// W, of constant forces that turn with their bodies.
struct AppliedPower {
  double power = 0;
};
double applied_power(const Model& model, const State& s) {
  const double* v = s.f64(columns::velocity).data();
  double power = 0;
  for (size_t i = 0; i < model.count(); ++i) {
    const Body& b = model.bodies[i];
    const bool acts =
        b.motion == Motion::dynamic && b.force_turns && !(s.span<uint32_t>(columns::status)[i] & kRemoved);
    if (acts) power += flat::dot(pose_of(s, i).q * b.force, Vec2{v[3 * i], v[3 * i + 1]});
  }
  return power;
}

}  // namespace

const OutputTable& Rigid2d::outputs() {
  using R = Rigid2d;
  static const OutputTable kTable =
      OutputsOf<R>("a body, in the order of bodies and generators")
          .part("", [](const R& r) { return points_part(r.model_.count()); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(columns::position),
                 "centre of mass")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(columns::velocity),
                 "of the centre of mass")
          .field({"angle", "rad", Scalar::f64, 1, Meaning::angle}, column(columns::angle), "")
          .field({"angular_velocity", "rad/s"}, column(columns::angular_velocity), "")
          .field({"asleep", "1", Scalar::f64, 1, Meaning::asleep},
                 computed_by<R>([](const R& r, const State& s, ShownRows rows, double* out) {
                   const auto status = s.span<uint32_t>(columns::status);
                   for (size_t i = 0; i < rows.count; ++i)
                     out[i] = is_asleep(r.model_.light[i], status[i]) ? 1 : 0;
                 }),
                 "1 while the body sleeps and is not computed")
          .field({"contact_force", "N", Scalar::f64, 3}, computed_by<R>(&R::contact_forces),
                 "sum of the forces of its contacts, friction included")
          .field({"contact_load", "N"}, computed_by<R>(&R::contact_loads),
                 "summed magnitude of their normal forces: what squeezes the body")
          .field({"joint_force", "N", Scalar::f64, 3}, computed_by<R>(&R::joint_forces),
                 "sum of the forces of its joints")
          .field({"joint_torque", "N m"}, computed_by<R>(&R::joint_torques),
                 "sum of the torques of its joints")
          .field({"orientation", "1", Scalar::f64, 4, Meaning::orientation}, computed(orientations),
                 "rotation about z as unit quaternion w x y z")
          .part("joints",
                [](const R& r) {
                  const size_t n = r.model_.joints.size();
                  return n > 0 ? std::optional(values_part(n, PartInfo::Elements::joints)) : std::nullopt;
                })
          .field({"joints.force", "N", Scalar::f64, 3}, computed_by<R>(&R::forces_on_second),
                 "in part joints, a row per joint: force on its second body")
          .field({"joints.torque", "N m"}, computed_by<R>(&R::torques_on_second),
                 "in part joints: torque on its second body")
          .measured(
              &R::whole,
              {{"energy.kinetic", "J", &Whole::kinetic, "of all dynamic bodies"},
               {"energy.rotation", "J", &Whole::rotation, "rotational part of energy.kinetic"},
               {"energy.potential", "J", &Whole::potential,
                "of all conservative forces, including springs of joints"},
               {"energy.total", "J", &Whole::total, "their sum"},
               {"momentum.x", "kg m/s", &Whole::px, "of all dynamic bodies"},
               {"momentum.y", "kg m/s", &Whole::py},
               {"angular_momentum.z", "kg m^2/s", &Whole::spin, "about the origin"},
               {"speed.largest", "m/s", &Whole::fastest, "of all dynamic bodies"},
               {"count", "1", &Whole::count, "bodies"},
               {"awake", "1", &Whole::awake, "dynamic bodies that do not sleep"},
               {"substeps", "1", &Whole::substeps, "of a step, as many as the loads on light bodies need"},
               {"contacts", "1", &Whole::contacts, "pairs of shapes that touch or nearly do"},
               {"penetration", "m", &Whole::penetration, "deepest overlap"},
               {"sensed", "1", &Whole::sensed, "pairs of a sensor and a dynamic body in it"}})
          .measured(&R::all_joints,
                    {{"joints.gap", "m", &AllJoints::gap,
                      "largest distance between two points that a joint holds together"},
                     {"joints.broken", "1", &AllJoints::broken, "joints that have broken"},
                     {"joints.tilt", "rad", &AllJoints::tilt, "largest rotation that violates a joint"},
                     {"joints.force", "N", &AllJoints::force, "largest force in a joint"},
                     {"joints.torque", "N m", &AllJoints::torque, "largest torque in a joint"}})
          .when([](const R& r) { return !r.model_.joints.empty(); })
          .measured_each(
              [](const R& r) {
                std::vector<std::string> ids;
                for (const auto& [joint, id] : r.model_.names) ids.push_back(id);
                return ids;
              },
              &R::one_joint,
              {{"joint.<id>.force", "N", &OneJoint::force, "force in the joint of that id"},
               {"joint.<id>.torque", "N m", &OneJoint::torque},
               {"joint.<id>.broken", "1", &OneJoint::broken, "1 after it has broken"},
               {"joint.<id>.position", "m", &OneJoint::position,
                "prismatic and wheel joints: along the axis"},
               {"joint.<id>.angle", "rad", &OneJoint::angle, "revolute and wheel joints: of b relative to a"},
               {"joint.<id>.length", "m", &OneJoint::length,
                "distance and spring joints: between the two points"}})
          .measured(
              [](const R& r, const State& s, double) { return AppliedPower{applied_power(r.model_, s)}; },
              {{"power.applied", "W", &AppliedPower::power,
                "if bodies have a constant force or torque: power of those without a potential"}})
          .when([](const R& r) { return !r.model_.forced.empty(); })
          .build();
  return kTable;
}

const Outputs& rigid2d_outputs() {
  static const Outputs kDescribed = Rigid2d::outputs().described();
  return kDescribed;
}

Rigid2d::Whole Rigid2d::whole(const State& s, double) const {
  const double *x = s.f64(columns::position).data(), *v = s.f64(columns::velocity).data();
  const auto w = s.f64(columns::angular_velocity), g = s.f64(columns::parameters);
  const auto status = s.span<uint32_t>(columns::status);
  Whole out;
  out.potential = spring_energy(model_, s);
  double linear = 0;
  for (size_t i = 0; i < model_.count(); ++i) {
    const Body& b = model_.bodies[i];
    if (status[i] & kRemoved) continue;
    out.count += 1;
    if (b.motion != Motion::dynamic) continue;
    const Vec2 at{x[3 * i], x[3 * i + 1]}, u{v[3 * i], v[3 * i + 1]};
    linear += 0.5 * b.mass * flat::dot(u, u), out.rotation += 0.5 * b.inertia * w[i] * w[i];
    out.potential -= b.mass * b.gravity_scale * (g[0] * at.x + g[1] * at.y);
    out.potential -= b.torque * s.f64(columns::angle)[i] + (b.force_turns ? 0 : flat::dot(b.force, at));
    out.px += b.mass * u.x, out.py += b.mass * u.y;
    out.spin += b.mass * flat::cross(at, u) + b.inertia * w[i];
    out.awake += is_moved(model_.light[i], status[i]);
    out.fastest = std::max(out.fastest, std::sqrt(flat::dot(u, u)));
  }
  out.kinetic = linear + out.rotation, out.total = out.kinetic + out.potential;
  out.substeps = substeps(s), out.contacts = static_cast<double>(s.rows(columns::contact_key));
  out.penetration = deepest(model_, s);
  if (std::ranges::any_of(model_.bodies, &Body::sensor)) out.sensed = static_cast<double>(sensor_overlaps(s));
  return out;
}

Rigid2d::AllJoints Rigid2d::all_joints(const State& s, double) const {
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  const double h = settings_for(dt_, substeps(s)).h;
  AllJoints out{.gap = widest_gap(model_, s), .broken = static_cast<double>(std::ranges::count(broken, 1u))};
  for (size_t k = 0; k < model_.joints.size(); ++k) {
    const Joint& j = model_.joints[k];
    if (broken[k]) continue;
    const JointImpulse p = joint_impulse(j, impulses_of(s, k));
    out.force = std::max(out.force, p.force / h), out.torque = std::max(out.torque, p.torque / h);
    if (j.kind == JointKind::prismatic || (j.kind == JointKind::weld && !j.has_spring))
      out.tilt = std::max(out.tilt, std::abs(joint_angle(j, s)));
  }
  return out;
}

Rigid2d::OneJoint Rigid2d::one_joint(const State& s, double, size_t name) const {
  const uint32_t k = model_.names[name].first;
  const Joint& j = model_.joints[k];
  OneJoint out{.broken = static_cast<double>(s.span<uint32_t>(columns::joint_broken)[k])};
  if (out.broken == 0) {
    const double h = settings_for(dt_, substeps(s)).h;
    const JointImpulse p = joint_impulse(j, impulses_of(s, k));
    out.force = p.force / h, out.torque = p.torque / h;
  }
  using enum JointKind;
  if (j.kind == distance) out.length = joint_coordinate(j, model_, s);
  if (j.kind == prismatic || j.kind == wheel) out.position = joint_coordinate(j, model_, s);
  if (j.kind == revolute || j.kind == wheel) out.angle = joint_angle(j, s);
  return out;
}

}  // namespace truestep::rigid2d
