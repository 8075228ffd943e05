#include "engine/systems/rigid2d/joint_energy.h"

#include <algorithm>
#include <cmath>

#include "engine/systems/rigid2d/joint_loads.h"

namespace truestep::rigid2d {

double spring_energy(const Model& model, const State& s) {
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  double sum = 0;
  for (size_t i = 0; i < model.joints.size(); ++i) {
    const Joint& j = model.joints[i];
    if (!j.has_spring || broken[i]) continue;
    const double off = joint_coordinate(j, model, s) - j.rest;
    sum += 0.5 * j.stiffness * off * off;
  }
  return sum;
}

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

bool joints_drive(const Model& model, const State& s) {
  const auto works = [](const Joint& j) {
    return j.has_motor || j.kind == JointKind::motor || j.kind == JointKind::mouse;
  };
  return std::any_of(model.joints.begin(), model.joints.end(), works) ||
         widest_gap(model, s) > 0.01 * model.size;
}

}  // namespace truestep::rigid2d
