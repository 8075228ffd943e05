// Joints of the system "rigid2d" as users see them: their observables, and their loads as fields of joints
// and bodies.
#include <algorithm>
#include <cmath>

#include "engine/systems/rigid2d/joint_energy.h"
#include "engine/systems/rigid2d/joint_loads.h"
#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep::rigid2d {

void Rigid2d::observe_joints(const State& s, Observables& out) const {
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  const double* impulses = s.f64(columns::joint_impulse).data();
  const double h = settings_for(dt_, substeps(s)).h;
  const auto load = [&](size_t k) {
    const JointImpulse p = joint_impulse(model_.joints[k], std::span<const double, 6>(impulses + 6 * k, 6));
    return JointImpulse{p.force / h, p.torque / h};
  };
  double tilt = 0, force = 0, torque = 0;
  for (size_t k = 0; k < model_.joints.size(); ++k) {
    const Joint& j = model_.joints[k];
    if (broken[k]) continue;
    const JointImpulse p = load(k);
    force = std::max(force, p.force), torque = std::max(torque, p.torque);
    if (j.kind == JointKind::prismatic || (j.kind == JointKind::weld && !j.has_spring)) {
      tilt = std::max(tilt, std::abs(joint_angle(j, s)));
    }
  }
  out.add("joints.gap", widest_gap(model_, s), "m");
  out.add("joints.broken", static_cast<double>(std::count(broken.begin(), broken.end(), 1u)), "1");
  out.add("joints.tilt", tilt, "rad");
  out.add("joints.force", force, "N");
  out.add("joints.torque", torque, "N m");
  for (const auto& [k, id] : model_.names) {
    const Joint& j = model_.joints[k];
    const std::string name = "joint." + id;
    const JointImpulse p = broken[k] ? JointImpulse{} : load(k);
    out.add(name + ".force", p.force, "N");
    out.add(name + ".torque", p.torque, "N m");
    out.add(name + ".broken", broken[k], "1");
    const double at = joint_coordinate(j, model_, s);
    if (j.kind == JointKind::distance) out.add(name + ".length", at, "m");
    if (j.kind == JointKind::prismatic || j.kind == JointKind::wheel) out.add(name + ".position", at, "m");
    if (j.kind == JointKind::revolute || j.kind == JointKind::wheel) {
      out.add(name + ".angle", joint_angle(j, s), "rad");
    }
  }
}

FieldView Rigid2d::joint_field(const State& s, size_t which, std::vector<double>& scratch) const {
  const size_t n = model_.joints.size();
  const double h = settings_for(dt_, substeps(s)).h;
  const uint32_t width = which == 0 ? 3 : 1;
  scratch.assign(n * width, 0);
  for (size_t k = 0; k < n; ++k) {
    const JointLoad load = joint_load(model_, s, k, h);
    if (which == 0) {
      scratch[3 * k] = load.force.x, scratch[3 * k + 1] = load.force.y;
    } else {
      scratch[k] = load.torque;
    }
  }
  return {scratch.data(), Scalar::f64, n, width};
}

void Rigid2d::joint_forces(const State& s, std::span<double> out) const {
  std::fill(out.begin(), out.end(), 0.0);
  const double h = settings_for(dt_, substeps(s)).h;
  const auto add = [&](uint32_t body, Vec2 force) {
    if (body < model_.count()) out[3 * body] += force.x, out[3 * body + 1] += force.y;
  };
  for (size_t k = 0; k < model_.joints.size(); ++k) {
    const Joint& j = model_.joints[k];
    const JointLoad load = joint_load(model_, s, k, h);
    add(j.b, load.force);
    add(j.a, force_on_first(model_, j, s, load));
  }
}

void Rigid2d::joint_torques(const State& s, std::span<double> out) const {
  std::fill(out.begin(), out.end(), 0.0);
  const double h = settings_for(dt_, substeps(s)).h;
  for (size_t k = 0; k < model_.joints.size(); ++k) {
    const Joint& j = model_.joints[k];
    if (j.kind == JointKind::gear) continue;
    const double torque = joint_load(model_, s, k, h).torque;
    if (j.a < model_.count()) out[j.a] -= torque;
    if (j.b < model_.count()) out[j.b] += torque;
  }
}

}  // namespace truestep::rigid2d
