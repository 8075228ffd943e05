// Effects of commands on a rigid2d state; errors name the wrong member of the command.
#include <algorithm>

#include "engine/core/commands/command_checks.h"
#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep::rigid2d {
void Rigid2d::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind == CommandKind::set_parameter) return set_parameter(s, c);
  if (c.value < 0) refuse_command("value", "out_of_range", "the value must be at least 0");
  const auto status = s.span<uint32_t>(columns::status);
  const auto row = [&] { return static_cast<uint32_t>(checked_command_row(c, model_.count(), "body")); };
  const auto dynamic = [&] {
    const uint32_t r = row();
    if (model_.bodies[r].motion != Motion::dynamic) {
      refuse_command("index", "not_dynamic", "the body in this row is not dynamic: forces do not move it");
    }
    return r;
  };
  // The point about the body's centre of mass, in its own frame.
  const auto local = [&](uint32_t body) -> std::optional<Vec3> {
    if (!c.at) return std::nullopt;
    const Vec2 p = pose_of(s, body).back(flat::flatten(*c.at));
    return Vec3{p.x, p.y, 0};
  };
  // The neighbours of a body that appears, disappears or is held must wake.
  const auto wake_neighbours = [&](uint32_t body) {
    std::vector<uint8_t> seeds(model_.count());
    for (const uint64_t key : s.span<uint64_t>(columns::contact_key)) {
      const uint32_t a = model_.body_of[key >> 32], b = model_.body_of[static_cast<uint32_t>(key)];
      if (a == body) seeds[b] = 1;
      if (b == body) seeds[a] = 1;
    }
    wake_islands(model_, s, seeds);
  };
  double* v = s.f64(columns::velocity).data();
  const auto w = s.f64(columns::angular_velocity);
  switch (c.kind) {
    case CommandKind::push: {
      const uint32_t r = dynamic();
      wake(s, r);
      return columns::kHands.add_push(s, {r, c.vector, local(r).value_or(Vec3{})}, c.duration);
    }
    case CommandKind::impulse: {
      const uint32_t body = dynamic();
      const Body& b = model_.bodies[body];
      wake(s, body);
      if (!is_moved(model_.light[body], status[body])) return;
      v[3 * body] += b.inverse_mass * c.vector.x, v[3 * body + 1] += b.inverse_mass * c.vector.y;
      const Vec2 arm = pose_of(s, body).q * flat::flatten(local(body).value_or(Vec3{}));
      w[body] += b.inverse_inertia * flat::cross(arm, flat::flatten(c.vector));
      return;
    }
    case CommandKind::drag: {
      const uint32_t r = dynamic();
      // A drag without a given stiffness pulls like a spring of 3 Hz.
      const double usual = 355 * model_.bodies[r].mass;
      wake(s, r);
      return columns::kHands.set_drag(s, r, c.vector, c.value > 0 ? c.value : usual, local(r));
    }
    case CommandKind::release:
      return columns::kHands.release(s, c.index == -1 ? std::nullopt : std::optional<uint64_t>(row()));
    case CommandKind::pin: {
      const uint32_t body = dynamic();
      wake(s, body);
      status[body] |= kPinned;
      v[3 * body] = v[3 * body + 1] = 0, w[body] = 0;
      return;
    }
    case CommandKind::unpin: {
      const uint32_t body = dynamic();
      status[body] = (status[body] & ~uint32_t{kPinned}) | kAwake;
      s.f64(columns::sleep_timer)[body] = 0;
      return wake_neighbours(body);
    }
    case CommandKind::remove: {
      const uint32_t body = row();
      for (const Joint& j : model_.joints) {
        if (j.a == body || j.b == body) {
          refuse_command("index", "joined", "a body that a joint holds cannot be removed");
        }
      }
      wake_neighbours(body);
      status[body] |= kRemoved;
      v[3 * body] = v[3 * body + 1] = 0, w[body] = 0;
      return;
    }
    case CommandKind::set_parameter:
    case CommandKind::spawn:
      break;
  }
  refuse_command("type", "unsupported_command",
                 "this system has only the bodies of its scene: none can be spawned",
                 "push, impulse, drag, release, pin, unpin, remove, set_parameter");
}

void Rigid2d::set_parameter(State& s, const Command& c) const {
  if (c.name == "gravity") {
    store3(s.f64(columns::parameters).data(), 0, c.vector);
    return (void)wake_islands(model_, s, std::vector<uint8_t>(model_.count(), 1));
  }
  for (const char* of_motor : {"motor_speed", "motor_target", "max_motor", "max_force", "max_torque",
                               "turn.motor_speed", "turn.motor_target"}) {
    if (c.name == of_motor) return set_motor(s, c);
  }
  const bool turn = c.name == "angular_velocity";
  if (!turn && c.name != "velocity") {
    refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                   "gravity, velocity, angular_velocity, motor_speed, motor_target, max_motor, max_force, "
                   "max_torque");
  }
  const auto body = static_cast<uint32_t>(checked_command_row(c, model_.count(), "body"));
  const uint32_t status = s.span<uint32_t>(columns::status)[body];
  if (model_.bodies[body].motion == Motion::fixed || (status & (kPinned | kRemoved))) {
    refuse_command("index", "not_movable", "body " + std::to_string(body) + " is held",
                   "a dynamic or kinematic body");
  }
  if (turn && model_.bodies[body].fixed_rotation) {
    refuse_command("index", "never_rotates", "body " + std::to_string(body) + " never rotates",
                   "a body without fixed_rotation");
  }
  if (turn) {
    s.f64(columns::angular_velocity)[body] = c.value;
  } else {
    store3(s.f64(columns::velocity).data(), body, {c.vector.x, c.vector.y, 0});
  }
  wake(s, body);
  s.f64(columns::sleep_timer)[body] = 0;
}

void Rigid2d::set_motor(State& s, const Command& c) const {
  const size_t k = checked_command_row(c, model_.joints.size(), "joint");
  const Joint& j = model_.joints[k];
  const bool pose = j.kind == JointKind::motor, mouse = j.kind == JointKind::mouse;
  const bool strength = c.name.starts_with("max_"), torque = c.name == "max_torque";
  const bool turns = c.name.starts_with("turn."), to_place = c.name.ends_with("motor_target");
  if (strength && c.value < 0)
    refuse_command("value", "out_of_range", "the maximum of the motor must be at least 0");
  bool takes = false;
  if (strength) {
    takes = (c.name == "max_motor") != (pose || mouse) && !(torque && mouse);
  } else if (pose) {
    takes = to_place != (turns ? j.at_spin : j.at_velocity);
  } else {
    takes = !turns && to_place == (mouse || j.has_target);
  }
  if (j.motor_row == kNoMotor || !takes) {
    refuse_command("index", "no_motor", "joint " + std::to_string(k) + " has no motor that takes " + c.name,
                   "a joint with motor_speed or motor_target in the scene, or of type motor or mouse");
  }
  check_command_form(c, (pose || mouse) && !turns && !strength);
  double* motor = s.f64(columns::joint_motor).data() + 3 * static_cast<size_t>(j.motor_row);
  if (turns || torque) {
    s.f64(columns::joint_turn_motor)[2 * static_cast<size_t>(j.motor_row) + (torque ? 1 : 0)] = c.value;
  } else if (strength) {
    motor[2] = c.value;
  } else if (pose || mouse) {
    motor[0] = c.vector.x, motor[1] = c.vector.y;
  } else {
    motor[0] = c.value;
  }
  for (const uint32_t body : {j.a, j.b}) {
    if (body == model_.world() || model_.light[body].motion != Motion::dynamic) continue;
    wake(s, body);
    s.f64(columns::sleep_timer)[body] = 0;
  }
}

}  // namespace truestep::rigid2d
