// Commands of the system "rigid3d".
#include "engine/core/commands/command_checks.h"
#include "engine/kernels/rigid/free_rotation.h"
#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

namespace {

// Point of action of a command, about the centre of mass in the body's frame.
std::optional<Vec3> place_on(const State& s, const Command& c, size_t body) {
  if (!c.at) return std::nullopt;
  const Rotation r = rotation(load_quat(s.f64(columns::orientation).data(), body));
  return r.apply_inverse(*c.at - load3(s.f64(columns::position).data(), body));
}

// "motor_speed" of "motor_speed" and "turn.motor_speed"; empty when the name is not of a motor.
std::string_view motor_parameter(std::string_view name) {
  name.remove_prefix(name.rfind('.') + 1);
  for (const char* known : {"motor_speed", "motor_target", "max_motor", "max_force", "max_torque"}) {
    if (name == known) return name;
  }
  return "";
}

}  // namespace

/// Row of the command; refused unless the body is dynamic.
size_t Rigid3d::checked_body(const State& s, const Command& c) const {
  const size_t i = checked_command_row(c, s.rows(columns::position), "body");
  if (!bodies_.kinds[s.span<uint32_t>(columns::kind)[i]].moved_by_forces()) {
    refuse_command("index", "not_dynamic", "forces do not move body " + std::to_string(i), "a dynamic body");
  }
  return i;
}

void Rigid3d::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  switch (c.kind) {
    case CommandKind::push: {
      const size_t i = checked_body(s, c);
      columns::kHands.add_push(
          s, {s.span<uint64_t>(columns::id)[i], c.vector, place_on(s, c, i).value_or(Vec3{})}, c.duration);
      return wake_body(s, i, bodies_.kinds);
    }
    case CommandKind::impulse: {
      const size_t i = checked_body(s, c);
      const BodyKind& b = bodies_.kinds[s.span<uint32_t>(columns::kind)[i]];
      double* v = s.f64(columns::velocity).data();
      store3(v, i, load3(v, i) + c.vector / b.mass);
      if (c.at) {
        double* w = s.f64(columns::angular_velocity).data();
        const Vec3 turn = cross(*c.at - load3(s.f64(columns::position).data(), i), c.vector);
        store3(w, i,
               load3(w, i) + free_rotation::spin_of(load_quat(s.f64(columns::orientation).data(), i), turn,
                                                    b.resistance()));
      }
      return wake_body(s, i, bodies_.kinds);
    }
    case CommandKind::drag: {
      const size_t i = checked_body(s, c);
      if (c.value < 0) refuse_command("value", "out_of_range", "the stiffness must be at least 0");
      // 100 m: a period of 0.6 s.
      const double mass = bodies_.kinds[s.span<uint32_t>(columns::kind)[i]].mass;
      columns::kHands.set_drag(s, s.span<uint64_t>(columns::id)[i], c.vector,
                               c.value > 0 ? c.value : 100 * mass, place_on(s, c, i));
      return wake_body(s, i, bodies_.kinds);
    }
    case CommandKind::release:
      return columns::kHands.release(
          s, c.index == -1 ? std::nullopt : std::optional(s.span<uint64_t>(columns::id)[checked_body(s, c)]));
    case CommandKind::spawn: {
      if (s.rows(columns::position) >= most_bodies_) {
        refuse_command("type", "full", "the system has its maximum number of bodies",
                       std::to_string(most_bodies_));
      }
      // "name" is the id of an entry of "bodies"; the default is the last dynamic entry.
      std::optional<uint32_t> chosen;
      for (uint32_t k = 0; k < bodies_.kinds.size(); ++k) {
        const BodyKind& b = bodies_.kinds[k];
        if (c.name.empty() ? b.moved_by_forces() : b.id == c.name) chosen = k;
      }
      if (!chosen) refuse_command("name", "unknown_body", "no entry of bodies has the id \"" + c.name + "\"");
      for (const uint32_t k : s.span<uint32_t>(columns::kind)) {
        if (!falls_through(bodies_.kinds[*chosen], bodies_.kinds[k])) continue;
        refuse_command("name", "surfaces_do_not_meet",
                       "a mesh does not collide with other meshes and height fields, and the scene has one: "
                       "it would fall "
                       "through",
                       "a hull, a compound or a box");
      }
      return append_body(s,
                         {*chosen, bodies_.kinds[*chosen].body_pose({c.vector, {}}), c.velocity, {}, false});
    }
    case CommandKind::remove: {
      const size_t i = checked_command_row(c, s.rows(columns::position), "body");
      const auto pairs = s.span<uint32_t>(columns::contact_bodies);
      for (size_t k = 0; k < pairs.size(); k += 2) {
        if (pairs[k] == i) wake_body(s, pairs[k + 1], bodies_.kinds);
        if (pairs[k + 1] == i) wake_body(s, pairs[k], bodies_.kinds);
      }
      return remove_body(s, i);
    }
    case CommandKind::set_parameter:
      return set_parameter(s, c);
    case CommandKind::pin:
    case CommandKind::unpin:
      break;
  }
  refuse_command("type", "unsupported_command", "bodies cannot be pinned; drag one instead",
                 "push, impulse, drag, release, spawn, remove, set_parameter");
}

void Rigid3d::set_parameter(State& s, const Command& c) const {
  const auto wake_all = [&] {
    for (size_t i = 0; i < s.rows(columns::asleep); ++i) {
      s.span<uint32_t>(columns::asleep)[i] = 0, s.f64(columns::sleep_timer)[i] = 0;
    }
  };
  if (c.name == "gravity") {
    store3(s.f64(columns::gravity).data(), 0, c.vector);
    return wake_all();
  }
  if (const std::string_view name = motor_parameter(c.name); !name.empty()) return set_motor(s, c, name);
  const bool turn = c.name == "angular_velocity";
  if (!turn && c.name != "velocity") {
    refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                   "gravity, velocity, angular_velocity, motor_speed, motor_target, max_motor, max_force, "
                   "max_torque");
  }
  const size_t i = checked_command_row(c, s.rows(columns::position), "body");
  const BodyKind& b = bodies_.kinds[s.span<uint32_t>(columns::kind)[i]];
  if (b.motion == BodyDef::Motion::fixed) {
    refuse_command("index", "not_movable", "body " + std::to_string(i) + " is fixed",
                   "a dynamic or kinematic body");
  }
  if (turn && b.fixed_rotation) {
    refuse_command("index", "never_rotates", "body " + std::to_string(i) + " never rotates",
                   "a body without fixed_rotation");
  }
  store3(s.f64(turn ? columns::angular_velocity : columns::velocity).data(), i, c.vector);
  if (b.moved_by_forces()) wake_body(s, i, bodies_.kinds);
}

}  // namespace truestep::rigid3d
