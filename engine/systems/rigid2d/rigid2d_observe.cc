// Observables of a rigid2d state (energies, momenta, contacts, joints) and fields for streams and pictures.
#include <algorithm>
#include <cmath>

#include "engine/collision/flat/distance.h"
#include "engine/systems/rigid2d/joint_energy.h"
#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep::rigid2d {
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

}  // namespace

std::optional<Energy> Rigid2d::energy(const State& s, double, Workspace&, const ThreadArena&) const {
  const double *x = s.f64(columns::position).data(), *v = s.f64(columns::velocity).data();
  const auto w = s.f64(columns::angular_velocity), g = s.f64(columns::parameters);
  const auto status = s.span<uint32_t>(columns::status);
  const double down = std::sqrt(g[0] * g[0] + g[1] * g[1]), pushed = settings_.push_out_speed;
  Energy e;
  bool driven = joints_drive(model_, s) || columns::kHands.any(s);
  for (size_t i = 0; i < model_.count(); ++i) {
    const Body& b = model_.bodies[i];
    const Vec2 at{x[3 * i], x[3 * i + 1]}, u{v[3 * i], v[3 * i + 1]};
    driven = driven || b.surface_speed != 0;
    if (b.motion != Motion::dynamic || (status[i] & kRemoved)) {
      driven = driven || flat::dot(u, u) + w[i] * w[i] > 0;
      continue;
    }
    driven = driven || b.torque != 0 || flat::dot(b.force, b.force) > 0;
    e.kinetic += 0.5 * b.mass * flat::dot(u, u) + 0.5 * b.inertia * w[i] * w[i];
    e.potential -= b.mass * b.gravity_scale * (g[0] * at.x + g[1] * at.y);
    e.slack += b.mass * (0.5 * pushed * pushed + std::abs(b.gravity_scale) * down * b.reach);
  }
  e.potential += spring_energy(model_, s);
  e.exchange = driven ? Energy::Exchange::open : Energy::Exchange::closed;
  return e;
}

void Rigid2d::observe(const State& s, double, Observables& out) const {
  const double *x = s.f64(columns::position).data(), *v = s.f64(columns::velocity).data();
  const auto w = s.f64(columns::angular_velocity), g = s.f64(columns::parameters);
  const auto status = s.span<uint32_t>(columns::status);
  double linear = 0, turning = 0, potential = spring_energy(model_, s), power = 0, fastest = 0;
  double px = 0, py = 0, spin = 0;
  size_t awake = 0, count = 0;
  for (size_t i = 0; i < model_.count(); ++i) {
    const Body& b = model_.bodies[i];
    if (status[i] & kRemoved) continue;
    ++count;
    if (b.motion != Motion::dynamic) continue;
    const Vec2 at{x[3 * i], x[3 * i + 1]}, u{v[3 * i], v[3 * i + 1]};
    linear += 0.5 * b.mass * flat::dot(u, u), turning += 0.5 * b.inertia * w[i] * w[i];
    potential -= b.mass * b.gravity_scale * (g[0] * at.x + g[1] * at.y);
    potential -= b.torque * s.f64(columns::angle)[i] + (b.force_turns ? 0 : flat::dot(b.force, at));
    if (b.force_turns) power += flat::dot(pose_of(s, i).q * b.force, u);
    px += b.mass * u.x, py += b.mass * u.y;
    spin += b.mass * flat::cross(at, u) + b.inertia * w[i];
    awake += is_moved(model_.light[i], status[i]);
    fastest = std::max(fastest, std::sqrt(flat::dot(u, u)));
  }
  const double kinetic = linear + turning;
  out.add("energy.kinetic", kinetic, "J");
  out.add("energy.rotation", turning, "J");
  out.add("energy.potential", potential, "J");
  out.add("energy.total", kinetic + potential, "J");
  if (!model_.forced.empty()) out.add("power.applied", power, "W");
  out.add("momentum.x", px, "kg m/s");
  out.add("momentum.y", py, "kg m/s");
  out.add("angular_momentum.z", spin, "kg m^2/s");
  out.add("speed.largest", fastest, "m/s");
  out.add("count", static_cast<double>(count), "1");
  out.add("awake", static_cast<double>(awake), "1");
  out.add("substeps", substeps(s), "1");
  out.add("contacts", static_cast<double>(s.rows(columns::contact_key)), "1");
  out.add("penetration", deepest(model_, s), "m");
  if (!model_.joints.empty()) observe_joints(s, out);
  if (std::any_of(model_.bodies.begin(), model_.bodies.end(), [](const Body& b) { return b.sensor; })) {
    out.add("sensed", static_cast<double>(sensor_overlaps(s)), "1");
  }
}

/// Pairs of a sensor and a dynamic body that overlap.
size_t Rigid2d::sensor_overlaps(const State& s) const {
  const auto status = s.span<uint32_t>(columns::status);
  const auto overlap = [&](const Body& a, const Pose& at_a, const Body& b, const Pose& at_b) {
    for (uint32_t i = a.first_shape; i < a.first_shape + a.shapes; ++i) {
      for (uint32_t j = b.first_shape; j < b.first_shape + b.shapes; ++j) {
        const Outline &p = model_.shapes[i].outline, &q = model_.shapes[j].outline;
        if (flat::bounds(p, at_a).overlaps(flat::bounds(q, at_b)) && flat::overlap(p, q, at_a.to(at_b)))
          return true;
      }
    }
    return false;
  };
  size_t count = 0;
  for (uint32_t i = 0; i < model_.count(); ++i) {
    const Body& sensor = model_.bodies[i];
    if (!sensor.sensor || (status[i] & kRemoved)) continue;
    const Pose at = pose_of(s, i);
    for (uint32_t j = 0; j < model_.count(); ++j) {
      const Body& b = model_.bodies[j];
      const bool seen = j != i && b.motion == Motion::dynamic && !b.sensor && !(status[j] & kRemoved) &&
                        (sensor.mask & b.category) && (b.mask & sensor.category);
      if (seen && overlap(sensor, at, b, pose_of(s, j))) ++count;
    }
  }
  return count;
}

void Rigid2d::name_parts() {
  PartInfo bodies;
  bodies.fields = {{"position", "m", Scalar::f64, 3, Meaning::position},
                   {"velocity", "m/s", Scalar::f64, 3, Meaning::velocity},
                   {"angle", "rad", Scalar::f64, 1, Meaning::angle},
                   {"angular_velocity", "rad/s"},
                   {"asleep", "1", Scalar::f64, 1, Meaning::asleep},
                   {"contact_force", "N", Scalar::f64, 3},
                   {"contact_load", "N"},
                   {"joint_force", "N", Scalar::f64, 3},
                   {"joint_torque", "N m"},
                   {"orientation", "1", Scalar::f64, 4, Meaning::orientation}};
  bodies.max_rows = model_.count();
  std::vector<PartInfo> parts{std::move(bodies)};
  if (!model_.joints.empty()) {
    PartInfo& joints = parts.emplace_back();
    joints.kind = PartInfo::Kind::values;
    joints.name = "joints";
    joints.elements = PartInfo::Elements::joints;
    joints.fields = {{"force", "N", Scalar::f64, 3}, {"torque", "N m"}};
    joints.max_rows = model_.joints.size();
  }
  set_parts(std::move(parts));
}

FieldView Rigid2d::field(const State& s, size_t part, size_t which, std::vector<double>& scratch) const {
  if (part == 1) return joint_field(s, which, scratch);
  enum : size_t {
    kPosition,
    kVelocity,
    kAngle,
    kAngularVelocity,
    kAsleep,
    kContactForce,
    kContactLoad,
    kJointForce,
    kJointTorque,
    kOrientation
  };
  const size_t n = model_.count();
  const auto column = [&](State::Column c, uint32_t width) {
    return FieldView{s.f64(c).data(), Scalar::f64, n, width};
  };
  switch (which) {
    case kPosition:
      return column(columns::position, 3);
    case kVelocity:
      return column(columns::velocity, 3);
    case kAngle:
      return column(columns::angle, 1);
    case kAngularVelocity:
      return column(columns::angular_velocity, 1);
    case kAsleep: {
      scratch.resize(n);
      const auto status = s.span<uint32_t>(columns::status);
      for (size_t i = 0; i < n; ++i) scratch[i] = is_asleep(model_.light[i], status[i]) ? 1 : 0;
      return {scratch.data(), Scalar::f64, n, 1};
    }
    case kContactForce:
      scratch.resize(3 * n);
      contact_forces(s, scratch);
      return {scratch.data(), Scalar::f64, n, 3};
    case kContactLoad:
      scratch.resize(n);
      contact_loads(s, scratch);
      return {scratch.data(), Scalar::f64, n, 1};
    case kJointForce:
      scratch.resize(3 * n);
      joint_forces(s, scratch);
      return {scratch.data(), Scalar::f64, n, 3};
    case kJointTorque:
      scratch.resize(n);
      joint_torques(s, scratch);
      return {scratch.data(), Scalar::f64, n, 1};
    default:
      break;
  }
  scratch.assign(4 * n, 0);
  const auto angle = s.f64(columns::angle);
  for (size_t i = 0; i < n; ++i) {
    const trig::SinCos half = trig::sincos(0.5 * angle[i]);
    scratch[4 * i] = half.cos, scratch[4 * i + 3] = half.sin;
  }
  return {scratch.data(), Scalar::f64, n, 4};
}

}  // namespace truestep::rigid2d
