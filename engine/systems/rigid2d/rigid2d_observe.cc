// What can be seen of a rigid2d state: energies, momenta, contacts, joints; fields for streams and pictures.
#include <algorithm>
#include <cmath>

#include "engine/collision/flat/distance.h"
#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep::rigid2d {
namespace {

Pose pose_or_world(const Model& model, const State& s, uint32_t body) {
  return body < model.count() ? pose_of(s, body) : Pose{};
}

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

/// Largest distance of two points that a joint should keep together.
double widest_gap(const Model& model, const State& s) {
  double gap = 0;
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  for (size_t i = 0; i < model.joints.size(); ++i) {
    const Joint& j = model.joints[i];
    if (broken[i]) continue;
    const Pose a = pose_or_world(model, s, j.a), b = pose_or_world(model, s, j.b);
    const Vec2 d = b * j.local_b - a * j.local_a;
    if (j.kind == JointKind::revolute || j.kind == JointKind::weld) gap = std::max(gap, flat::norm(d));
    if (j.kind == JointKind::prismatic || j.kind == JointKind::wheel) {
      gap = std::max(gap, std::abs(flat::cross(a.q * j.axis, d)));
    }
    if (j.kind == JointKind::distance && !j.has_spring && !j.has_lower && !j.has_upper) {
      gap = std::max(gap, std::abs(flat::norm(d) - j.length));
    }
  }
  return gap;
}

}  // namespace

void Rigid2d::observe(const State& s, double, Observables& out) const {
  const double *x = s.f64(columns::position).data(), *v = s.f64(columns::velocity).data();
  const auto w = s.f64(columns::angular_velocity), g = s.f64(columns::parameters);
  const auto status = s.span<uint32_t>(columns::status);
  double kinetic = 0, potential = 0, px = 0, py = 0, spin = 0;
  size_t awake = 0;
  for (size_t i = 0; i < model_.count(); ++i) {
    const Body& b = model_.bodies[i];
    if (b.motion != Motion::dynamic || (status[i] & kRemoved)) continue;
    const Vec2 at{x[3 * i], x[3 * i + 1]}, u{v[3 * i], v[3 * i + 1]};
    kinetic += 0.5 * b.mass * flat::dot(u, u) + 0.5 * b.inertia * w[i] * w[i];
    potential -= b.mass * b.gravity_scale * (g[0] * at.x + g[1] * at.y);
    px += b.mass * u.x, py += b.mass * u.y;
    spin += b.mass * flat::cross(at, u) + b.inertia * w[i];
    awake += is_moved(model_.light[i], status[i]);
  }
  out.add("energy.kinetic", kinetic, "J");
  out.add("energy.potential", potential, "J");
  out.add("energy.total", kinetic + potential, "J");
  out.add("momentum.x", px, "kg m/s");
  out.add("momentum.y", py, "kg m/s");
  out.add("momentum.angular", spin, "kg m^2/s");
  out.add("contacts", static_cast<double>(s.rows(columns::contact_key)), "1");
  out.add("penetration.max", deepest(model_, s), "m");
  out.add("awake", static_cast<double>(awake), "1");
  if (!model_.joints.empty()) {
    const auto broken = s.span<uint32_t>(columns::joint_broken);
    out.add("joint.gap", widest_gap(model_, s), "m");
    out.add("joints.broken", static_cast<double>(std::count(broken.begin(), broken.end(), 1u)), "1");
  }
  if (std::any_of(model_.bodies.begin(), model_.bodies.end(), [](const Body& b) { return b.sensor; })) {
    out.add("sensor.overlaps", static_cast<double>(sensor_overlaps(s)), "1");
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

std::vector<FieldInfo> Rigid2d::fields() const {
  return {{"position", "m", Scalar::f64, 3}, {"velocity", "m/s", Scalar::f64, 3},
          {"angle", "rad", Scalar::f64, 1},  {"angular_velocity", "rad/s", Scalar::f64, 1},
          {"awake", "1", Scalar::f64, 1},    {"contact_force", "N", Scalar::f64, 1}};
}

FieldView Rigid2d::field(const State& s, size_t which, std::vector<double>& scratch) const {
  const size_t n = drawing_.rows.size();
  const auto width = static_cast<uint32_t>(which < 2 ? 3 : 1);
  scratch.assign(n * width, 0);
  const double *x = s.f64(columns::position).data(), *v = s.f64(columns::velocity).data();
  const auto angle = s.f64(columns::angle), w = s.f64(columns::angular_velocity);
  const auto status = s.span<uint32_t>(columns::status);
  std::vector<double> force;
  if (which == 5) {
    force.assign(model_.count(), 0);
    const auto keys = s.span<uint64_t>(columns::contact_key);
    const auto impulse = s.span<float>(columns::contact_impulse);
    const double h = settings_for(dt_).h;
    for (size_t k = 0; k < keys.size(); ++k) {
      const double f = (impulse[5 * k] + impulse[5 * k + 1]) / h;
      force[model_.shapes[keys[k] >> 32].body] += f;
      force[model_.shapes[static_cast<uint32_t>(keys[k])].body] += f;
    }
  }
  uint32_t last = kNoPoint;
  Rotation q;
  for (size_t r = 0; r < n; ++r) {
    const Vertex& at = drawing_.rows[r];
    const size_t i = at.body;
    if (at.body != last && which < 2) q = pose_of(s, i).q;
    last = at.body;
    const Vec2 arm = (status[i] & kRemoved) ? Vec2{} : q * at.local;
    switch (which) {
      case 0:
        store3(scratch.data(), r, Vec3{x[3 * i] + arm.x, x[3 * i + 1] + arm.y, at.depth});
        break;
      case 1:
        store3(scratch.data(), r, Vec3{v[3 * i] - w[i] * arm.y, v[3 * i + 1] + w[i] * arm.x, 0});
        break;
      case 2:
        scratch[r] = angle[i];
        break;
      case 3:
        scratch[r] = w[i];
        break;
      case 4:
        scratch[r] = is_moved(model_.light[i], status[i]) ? 1 : 0;
        break;
      default:
        scratch[r] = force[i];
    }
  }
  return {scratch.data(), Scalar::f64, n, width};
}

}  // namespace truestep::rigid2d
