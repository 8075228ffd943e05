#include "engine/systems/rigid2d/columns.h"

#include <algorithm>

#include "engine/rigid/islands.h"

namespace truestep::rigid2d {

State state_at_start(const Model& model, const Vec3& gravity) {
  using S = Scalar;
  const size_t n = model.count();
  State s;
  s.add({"position", "m", S::f64, 3, Role::position}, n);
  s.add({"velocity", "m/s", S::f64, 3, Role::velocity}, n);
  s.add({"angle", "rad", S::f64, 1, Role::position}, n);
  s.add({"angular_velocity", "rad/s", S::f64, 1, Role::velocity}, n);
  s.add({"sleep_timer", "s", S::f64, 1}, n);
  s.add({"sleep_timer.place", "m", S::f64, 6}, n);
  s.add({"status", "1", S::u32, 1}, n);
  s.add({"contact.key", "1", S::u64, 1}, 0);
  s.add({"contact.id", "1", S::u32, 2}, 0);
  s.add({"contact.impulse", "N s", S::f32, 5}, 0);
  s.add({"contact.penetration_offset", "m", S::f32, 2}, 0);
  s.add({"joint.impulse", "N s", S::f64, 6}, model.joints.size());
  s.add({"joint.broken", "1", S::u32, 1}, model.joints.size());
  s.add({"small_steps", "1", S::u32, 1}, 1);  // as stored states call it
  s.add({"parameters", "m/s^2", S::f64, 3}, 1);
  s.add({"push.body", "1", S::u32, 1}, 0);
  s.add({"push.force", "N", S::f64, 3}, 0);
  s.add({"push.local", "m", S::f64, 2}, 0);
  s.add({"push.remaining", "s", S::f64, 1}, 0);
  s.add({"drag.body", "1", S::u32, 1}, 0);
  s.add({"drag.local", "m", S::f64, 2}, 0);
  s.add({"drag.target", "m", S::f64, 3}, 0);
  s.add({"drag.stiffness", "N/m", S::f64, 1}, 0);
  s.add({"drag.impulse", "N s", S::f64, 2}, 0);
  if (!model.motors.empty()) s.add({"joint.motor", "SI", S::f64, 3, Role::sentinel}, model.motors.size());
  for (size_t k = 0; k < model.motors.size(); ++k) {
    const Joint& j = model.joints[model.motors[k]];
    Vec3 motor{j.has_target ? j.motor_target : j.motor_speed, 0, j.max_motor};
    if (j.kind == JointKind::motor) motor = {j.move.x, j.move.y, j.max_force};
    if (j.kind == JointKind::mouse) motor = {j.ground_a.x, j.ground_a.y, j.max_force};
    store3(s.f64(columns::joint_motor).data(), k, motor);
  }
  const auto turns = [&](uint32_t joint) { return model.joints[joint].kind == JointKind::motor; };
  if (std::ranges::any_of(model.motors, turns)) {
    s.add({"joint.turn_motor", "SI", S::f64, 2}, model.motors.size());
    for (size_t k = 0; k < model.motors.size(); ++k) {
      const Joint& j = model.joints[model.motors[k]];
      s.f64(columns::joint_turn_motor)[2 * k] = j.at_spin ? j.spin : j.turn;
      s.f64(columns::joint_turn_motor)[2 * k + 1] = j.max_torque;
    }
  }
  store3(s.f64(columns::parameters).data(), 0, gravity);
  for (size_t i = 0; i < n; ++i) {
    const Body& b = model.bodies[i];
    store3(s.f64(columns::position).data(), i, Vec3{b.position.x, b.position.y, 0});
    store3(s.f64(columns::velocity).data(), i, Vec3{b.velocity.x, b.velocity.y, 0});
    s.f64(columns::angle)[i] = b.angle;
    s.f64(columns::angular_velocity)[i] = b.angular_velocity;
    s.span<uint32_t>(columns::status)[i] = b.asleep ? 0u : static_cast<uint32_t>(kAwake);
  }
  return s;
}

bool wake_islands(const Model& model, State& s, std::span<const uint8_t> seeds) {
  const size_t n = model.count();
  const auto status = s.span<uint32_t>(columns::status);
  const auto sleeps = [&](uint32_t i) { return i < n && is_asleep(model.light[i], status[i]); };
  std::vector<uint32_t> parent(n);
  start_islands(parent);
  for (const uint64_t key : s.span<uint64_t>(columns::contact_key)) {
    const uint32_t a = model.body_of[key >> 32], b = model.body_of[static_cast<uint32_t>(key)];
    if (sleeps(a) && sleeps(b)) link_islands(parent, a, b);
  }
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  for (size_t j = 0; j < model.joints.size(); ++j) {
    const Joint& joint = model.joints[j];
    if (!broken[j] && sleeps(joint.a) && sleeps(joint.b)) link_islands(parent, joint.a, joint.b);
  }
  std::vector<uint8_t> wakes(n);
  bool any = false;
  for (uint32_t i = 0; i < n; ++i) {
    if (seeds[i] && sleeps(i)) wakes[island_of(parent, i)] = 1, any = true;
  }
  if (!any) return false;
  const auto rest = s.f64(columns::sleep_timer);
  for (uint32_t i = 0; i < n; ++i) {
    if (!sleeps(i) || !wakes[island_of(parent, i)]) continue;
    status[i] = kAwake, rest[i] = 0;
  }
  return true;
}

}  // namespace truestep::rigid2d
