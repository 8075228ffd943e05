// Loads of the joints of the system "rigid2d" as fields of joints and bodies.
#include <algorithm>

#include "engine/systems/rigid2d/joint_loads.h"
#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep::rigid2d {

void Rigid2d::forces_on_second(const State& s, ShownRows joints, double* out) const {
  const double h = settings_for(dt_, substeps(s)).h;
  for (size_t k = 0; k < joints.count; ++k) {
    const Vec2 force = joint_load(model_, s, k, h).force;
    store3(out, k, Vec3{force.x, force.y, 0});
  }
}

void Rigid2d::torques_on_second(const State& s, ShownRows joints, double* out) const {
  const double h = settings_for(dt_, substeps(s)).h;
  for (size_t k = 0; k < joints.count; ++k) out[k] = joint_load(model_, s, k, h).torque;
}

void Rigid2d::joint_forces(const State& s, ShownRows bodies, double* out) const {
  std::fill_n(out, 3 * bodies.count, 0.0);
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

void Rigid2d::joint_torques(const State& s, ShownRows bodies, double* out) const {
  std::fill_n(out, bodies.count, 0.0);
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
