// What rigid bodies in space give out.
#include <algorithm>
#include <cmath>

#include "engine/core/outputs/outputs_of.h"
#include "engine/kernels/rigid/free_rotation.h"
#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

struct Rigid3d::Whole {
  double kinetic = 0, rotation = 0, potential = 0, total = 0;
  Vec3 momentum{}, angular_momentum{};
  double fastest = 0, count = 0, awake = 0, substeps = 0, contacts = 0, penetration = 0, sensed = 0;
};
struct Rigid3d::AllJoints {
  double gap = 0, broken = 0;
  std::optional<double> tilt = {}, force = {}, torque = {};
};
struct Rigid3d::OneJoint {
  double force = 0, torque = 0, broken = 0;
  std::optional<double> position = {}, angle = {}, length = {};
};

namespace {

struct Number {
  double value;
};

/// What part "joints" shows of unbroken joints: their loads on the second body, `which` of two vectors each.
auto load_column(size_t which) {
  return computed([which](const State& s, ShownRows rows, double* out) {
    std::fill_n(out, 3 * rows.count, 0.0);
    const double* load = s.f64(columns::joint_load).data();
    for (size_t k = 0; k < rows.count; ++k)
      if (!s.span<uint32_t>(columns::joint_broken)[k]) store3(out, k, load3(load, 2 * k + which));
  });
}

/// Free coordinates of a joint among the three from `first` on: its translations from 0, its rotations
/// from 3.
std::vector<size_t> freedoms(const Joint& j, size_t first) {
  std::vector<size_t> out;
  if (j.form == Joint::Form::gear || j.form == Joint::Form::line) return out;
  if (first == 3 && j.form == Joint::Form::free) return out;
  for (size_t e = first; e < first + 3; ++e)
    if (!j.locked[e]) out.push_back(e);
  return out;
}

}  // namespace

const OutputTable& Rigid3d::outputs() {
  using R = Rigid3d;
  const auto of_joints = [](JointLoad what) {
    return computed_by<R>([what](const R& r, const State& s, ShownRows rows, double* out) {
      r.joint_loads(s, what, rows, out);
    });
  };
  const auto axis_names = [](std::vector<Axis> R::*kind) {
    return [kind](const R& r) {
      static constexpr const char* kNames[6] = {".x", ".y", ".z", ".turn_x", ".turn_y", ".turn_z"};
      std::vector<std::string> names;
      for (const Axis& a : r.*kind) names.push_back(r.joints_.joints[a.joint].id + kNames[a.coordinate]);
      return names;
    };
  };
  const auto axis_values = [](std::vector<Axis> R::*kind) {
    return [kind](const R& r, const State& s, double, size_t k) {
      const Axis a = (r.*kind)[k];
      return Number{r.coordinates(s, a.joint)[a.coordinate]};
    };
  };
  static const OutputTable kTable =
      OutputsOf<R>("a body: every entry of bodies with its copies, in order, then spawned bodies")
          .part("", [](const R& r) { return points_part(r.most_bodies_); })
          .rows(present_rows(columns::position))
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(columns::position),
                 "centre of mass")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(columns::velocity),
                 "of the centre of mass")
          .field({"orientation", "1", Scalar::f64, 4, Meaning::orientation}, column(columns::orientation),
                 "unit quaternion w x y z of the principal axes")
          .field({"angular_velocity", "rad/s", Scalar::f64, 3}, column(columns::angular_velocity),
                 "in the world")
          .field({"asleep", "1", Scalar::u32, 1, Meaning::asleep}, column(columns::asleep),
                 "1 while the body sleeps and is not computed")
          .field({"shape", "1"}, computed_by<R>([](const R& r, const State& s, ShownRows rows, double* out) {
                   const auto kind = s.span<uint32_t>(columns::kind);
                   for (size_t i = 0; i < rows.count; ++i)
                     out[i] = static_cast<double>(r.bodies_.kinds[kind[i]].solid.kind);
                 }),
                 "index of its shape")
          .field({"size", "m", Scalar::f64, 3},
                 computed_by<R>([](const R& r, const State& s, ShownRows rows, double* out) {
                   const auto kind = s.span<uint32_t>(columns::kind);
                   for (size_t i = 0; i < rows.count; ++i)
                     store3(out, i, r.bodies_.kinds[kind[i]].solid.size);
                 }),
                 "radius, half extents or half length of its shape")
          .field({"contact_force", "N", Scalar::f64, 3}, computed_by<R>(&R::contact_forces),
                 "sum of the forces of its contacts, friction included")
          .field({"contact_load", "N"}, computed_by<R>(&R::contact_loads),
                 "summed magnitude of their normal forces: what squeezes the body")
          .field({"joint_force", "N", Scalar::f64, 3}, of_joints(JointLoad::force),
                 "sum of the forces of its joints")
          .field({"joint_torque", "N m", Scalar::f64, 3}, of_joints(JointLoad::torque),
                 "sum of the torques of its joints")
          .part("joints",
                [](const R& r) {
                  const size_t n = r.joints_.joints.size();
                  return n > 0 ? std::optional(values_part(n, PartInfo::Elements::joints)) : std::nullopt;
                })
          .field({"joints.force", "N", Scalar::f64, 3}, load_column(0),
                 "in part joints, a row per joint: force on its second body")
          .field({"joints.torque", "N m", Scalar::f64, 3}, load_column(1),
                 "in part joints: torque on its second body")
          .measured(
              &R::whole,
              {{"energy.kinetic", "J", &Whole::kinetic, "of all dynamic bodies"},
               {"energy.rotation", "J", &Whole::rotation, "rotational part of energy.kinetic"},
               {"energy.potential", "J", &Whole::potential,
                "of all conservative forces, including springs of joints"},
               {"energy.total", "J", &Whole::total, "their sum"},
               {"momentum", "kg m/s", &Whole::momentum, "of all dynamic bodies"},
               {"angular_momentum", "kg m^2/s", &Whole::angular_momentum, "about the origin"},
               {"speed.largest", "m/s", &Whole::fastest, "of all dynamic bodies"},
               {"count", "1", &Whole::count, "bodies"},
               {"awake", "1", &Whole::awake, "dynamic bodies that do not sleep"},
               {"substeps", "1", &Whole::substeps, "of a step, as many as the loads on light bodies need"},
               {"contacts", "1", &Whole::contacts, "pairs of bodies that touch or nearly do"},
               {"penetration", "m", &Whole::penetration, "deepest overlap"},
               {"sensed", "1", &Whole::sensed, "pairs of a sensor and a body in it"}})
          .measured(&R::all_joints,
                    {{"joints.gap", "m", &AllJoints::gap,
                      "largest distance between two points that a joint holds together"},
                     {"joints.broken", "1", &AllJoints::broken, "joints that have broken"},
                     {"joints.tilt", "rad", &AllJoints::tilt, "largest rotation that violates a joint"},
                     {"joints.force", "N", &AllJoints::force, "largest force in a joint"},
                     {"joints.torque", "N m", &AllJoints::torque, "largest torque in a joint"}})
          .measured_each(
              [](const R& r) {
                std::vector<std::string> ids;
                for (const size_t k : r.named_) ids.push_back(r.joints_.joints[k].id);
                return ids;
              },
              &R::one_joint,
              {{"joint.<id>.force", "N", &OneJoint::force, "force in the joint of that id"},
               {"joint.<id>.torque", "N m", &OneJoint::torque},
               {"joint.<id>.broken", "1", &OneJoint::broken, "1 after it has broken"},
               {"joint.<id>.position", "m", &OneJoint::position, "position along its single translation"},
               {"joint.<id>.angle", "rad", &OneJoint::angle, "angle about its single free axis"},
               {"joint.<id>.length", "m", &OneJoint::length,
                "distance and spring joints: between the two points"}})
          .measured_each(axis_names(&R::slides_), axis_values(&R::slides_),
                         {{"joint.<id>.<axis>", "m", &Number::value,
                           "position along x, y, z if it has several translations"}})
          .measured_each(axis_names(&R::turns_), axis_values(&R::turns_),
                         {{"joint.<id>.turn_<axis>", "rad", &Number::value,
                           "angle about x, y, z if it has several rotations"}})
          .measured([](const R& r, const State& s, double) { return Number{r.applied_power(s)}; },
                    {{"power.applied", "W", &Number::value,
                      "if bodies have a constant force or torque: power of those without a potential"}})
          .when([](const R& r) { return std::ranges::any_of(r.bodies_.kinds, &BodyKind::forced); })
          .build();
  return kTable;
}

const Outputs& rigid3d_outputs() {
  static const Outputs kDescribed = Rigid3d::outputs().described();
  return kDescribed;
}

Rigid3d::Whole Rigid3d::whole(const State& s, double) const {
  const auto kind = s.span<uint32_t>(columns::kind), asleep = s.span<uint32_t>(columns::asleep);
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  const Vec3 g = load3(s.f64(columns::gravity).data(), 0);
  Whole out;
  out.potential = spring_energy(s);
  double linear = 0;
  for (size_t i = 0; i < kind.size(); ++i) {
    const BodyKind& b = bodies_.kinds[kind[i]];
    if (!b.moved_by_forces()) continue;
    const Vec3 p = load3(v, i) * b.mass;
    const Vec3 L = free_rotation::momentum({load_quat(q, i), load3(w, i)}, b.moments);
    linear += 0.5 * dot(p, load3(v, i)), out.rotation += 0.5 * dot(L, load3(w, i));
    out.potential -= b.mass * b.gravity_scale * dot(g, load3(x, i));
    if (!b.force_turns) out.potential -= dot(b.force, load3(x, i));
    out.momentum += p, out.angular_momentum += L + cross(load3(x, i), p);
    out.awake += asleep[i] == 0;
    out.fastest = std::max(out.fastest, norm(load3(v, i)));
  }
  out.kinetic = linear + out.rotation, out.total = out.kinetic + out.potential;
  out.count = static_cast<double>(kind.size()), out.substeps = substeps(s, dt_);
  const auto bodies = s.span<uint32_t>(columns::contact_bodies);
  const auto depths = s.f64(columns::contact_depth);
  out.contacts = static_cast<double>(s.rows(columns::contact_bodies));
  for (size_t k = 0; k < depths.size(); ++k) {
    const bool sensor =
        bodies_.kinds[kind[bodies[2 * k]]].sensor || bodies_.kinds[kind[bodies[2 * k + 1]]].sensor;
    out.sensed += sensor;
    if (!sensor) out.penetration = std::max(out.penetration, depths[k]);
  }
  return out;
}

double Rigid3d::applied_power(const State& s) const {
  const auto kind = s.span<uint32_t>(columns::kind);
  double power = 0;
  for (size_t i = 0; i < kind.size(); ++i) {
    const BodyKind& b = bodies_.kinds[kind[i]];
    if (!b.moved_by_forces() || !b.forced()) continue;
    const Rotation R = rotation(load_quat(s.f64(columns::orientation).data(), i));
    const Vec3 v = load3(s.f64(columns::velocity).data(), i),
               w = load3(s.f64(columns::angular_velocity).data(), i);
    power += b.force_turns ? dot(R.apply(b.force), v) + dot(R.apply(b.torque), w) : dot(b.torque, w);
  }
  return power;
}

Rigid3d::AllJoints Rigid3d::all_joints(const State& s, double) const {
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  AllJoints out{.gap = widest_gap(s), .broken = static_cast<double>(std::ranges::count(broken, 1u))};
  if (joints_.joints.empty()) return out;
  const double* load = s.f64(columns::joint_load).data();
  double tilt = 0, force = 0, torque = 0;
  for (size_t k = 0; k < joints_.joints.size(); ++k) {
    if (broken[k]) continue;
    const Joint& j = joints_.joints[k];
    const JointPlace at = place_of(s, k);
    double turned = 0;
    for (size_t e = 3; e < 6; ++e) turned += j.locked[e] * at.coordinate[e] * at.coordinate[e];
    tilt = std::max(tilt, std::sqrt(turned));
    force = std::max(force, norm(load3(load, 2 * k))),
    torque = std::max(torque, norm(load3(load, 2 * k + 1)));
  }
  out.tilt = tilt, out.force = force, out.torque = torque;
  return out;
}

void Rigid3d::name_joints() {
  for (size_t k = 0; k < joints_.joints.size(); ++k) {
    const Joint& j = joints_.joints[k];
    if (j.id.empty()) continue;
    named_.push_back(k);
    const auto add = [&](std::vector<Axis>& to, const std::vector<size_t>& free) {
      for (size_t i = 0; free.size() > 1 && i < free.size(); ++i) to.push_back({k, free[i]});
    };
    add(slides_, freedoms(j, 0)), add(turns_, freedoms(j, 3));
  }
}

std::array<double, 6> Rigid3d::coordinates(const State& s, size_t joint) const {
  const Joint& j = joints_.joints[joint];
  const JointPlace at = place_of(s, joint);
  std::array<double, 6> out;
  std::copy(at.coordinate, at.coordinate + 6, out.begin());
  for (uint32_t d = j.first_drive; d < j.first_drive + j.drives; ++d)
    out[joints_.drives[d].row] = s.f64(columns::drive_coordinate)[d];
  return out;
}

Rigid3d::OneJoint Rigid3d::one_joint(const State& s, double, size_t named) const {
  const size_t k = named_[named];
  const Joint& j = joints_.joints[k];
  const double* load = s.f64(columns::joint_load).data();
  OneJoint out{.force = norm(load3(load, 2 * k)),
               .torque = norm(load3(load, 2 * k + 1)),
               .broken = static_cast<double>(s.span<uint32_t>(columns::joint_broken)[k])};
  if (j.form == Joint::Form::gear) return out;
  const auto at = coordinates(s, k);
  if (j.form == Joint::Form::line) out.length = at[0] + j.length;
  const auto slides = freedoms(j, 0), turns = freedoms(j, 3);
  // A single translation or rotation has the plain name.
  if (slides.size() == 1) out.position = at[slides[0]];
  if (turns.size() == 1) out.angle = at[turns[0]];
  return out;
}

}  // namespace truestep::rigid3d
