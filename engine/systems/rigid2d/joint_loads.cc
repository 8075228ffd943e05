#include "engine/systems/rigid2d/joint_loads.h"

#include <cmath>

namespace truestep::rigid2d {

Pose pose_or_world(const Model& model, const State& s, uint32_t body) {
  return body == model.world() ? Pose{} : pose_of(s, body);
}

namespace {

// Motor, spring and limits: together along the axis or about it.
double drive_of(std::span<const double, 6> p) {
  return p[2] + p[5] + p[3] - p[4];
}

}  // namespace

double joint_angle(const Joint& j, const State& s) {
  const auto angles = s.f64(columns::angle);
  const auto angle = [&](uint32_t i) { return i < angles.size() ? angles[i] : 0.0; };
  return angle(j.b) - angle(j.a) - j.angle;
}

double joint_coordinate(const Joint& j, const Model& model, const State& s) {
  if (j.kind != JointKind::distance && j.kind != JointKind::prismatic && j.kind != JointKind::wheel) {
    return joint_angle(j, s);
  }
  const Pose a = pose_or_world(model, s, j.a), b = pose_or_world(model, s, j.b);
  const Vec2 d = b * j.local_b - a * j.local_a;
  return j.kind == JointKind::distance ? flat::norm(d) : flat::dot(a.q * j.axis, d);
}

JointImpulse joint_impulse(const Joint& j, std::span<const double, 6> p) {
  const auto size = [](double x, double y) { return std::sqrt(x * x + y * y); };
  switch (j.kind) {
    case JointKind::revolute:
      return {size(p[0], p[1]), std::abs(drive_of(p))};
    case JointKind::weld:
    case JointKind::motor:
    case JointKind::mouse:
      return {size(p[0], p[1]), std::abs(p[5])};
    case JointKind::prismatic:
      return {size(p[0], drive_of(p)), std::abs(p[1])};
    case JointKind::wheel:
      return {size(p[0], p[5] + p[3] - p[4]), std::abs(p[2])};
    case JointKind::distance:
      return {std::abs(p[0] + p[5] + p[3] - p[4]), 0};
    case JointKind::gear:
      return {0, std::abs(j.ratio * p[0])};
    case JointKind::pulley:
      return {std::abs(p[0]), 0};
  }
  return {};
}

JointLoad joint_load(const Model& model, const State& s, size_t joint, double h) {
  if (s.span<uint32_t>(columns::joint_broken)[joint] || !(h > 0)) return {};
  const Joint& j = model.joints[joint];
  const std::span<const double, 6> p(s.f64(columns::joint_impulse).data() + 6 * joint, 6);
  const double rate = 1 / h;
  const Pose a = pose_or_world(model, s, j.a), b = pose_or_world(model, s, j.b);
  const Vec2 u = a.q * j.axis;
  const auto along = [&](double x, double across) {
    return rate * Vec2{x * u.x - across * u.y, x * u.y + across * u.x};
  };
  switch (j.kind) {
    case JointKind::revolute:
      return {rate * Vec2{p[0], p[1]}, rate * drive_of(p)};
    case JointKind::weld:
    case JointKind::motor:
    case JointKind::mouse:
      return {rate * Vec2{p[0], p[1]}, rate * p[5]};
    case JointKind::prismatic:
      return {along(drive_of(p), p[0]), rate * p[1]};
    case JointKind::wheel:
      return {along(p[5] + p[3] - p[4], p[0]), rate * p[2]};
    case JointKind::distance: {
      const Vec2 n = flat::unit(b * j.local_b - a * j.local_a, {1, 0});
      return {(rate * (p[0] + p[5] + p[3] - p[4])) * n, 0};
    }
    case JointKind::gear:
      return {{}, rate * j.ratio * p[0]};
    case JointKind::pulley: {
      const Vec2 n = flat::unit(b * j.local_b - j.ground_b, {1, 0});
      return {(-rate * j.ratio * p[0]) * n, 0};
    }
  }
  return {};
}

Vec2 force_on_first(const Model& model, const Joint& j, const State& s, const JointLoad& load) {
  if (j.kind != JointKind::pulley) return -load.force;
  // One rope: both sides have its tension, b's counted `ratio` times.
  const Vec2 n = flat::unit(pose_or_world(model, s, j.a) * j.local_a - j.ground_a, {1, 0});
  return (-flat::norm(load.force) / j.ratio) * n;
}

}  // namespace truestep::rigid2d
