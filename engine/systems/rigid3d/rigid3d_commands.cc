// Commands of the system "rigid3d".
#include "engine/core/command_checks.h"
#include "engine/kernels/free_rotation.h"
#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep {

namespace columns = rigid3d_columns;

namespace {

void end_drags(State& s, std::optional<uint64_t> id) {
  size_t kept = 0;
  const auto ids = s.span<uint64_t>(columns::drag_id);
  double *target = s.f64(columns::drag_target).data(), *stiffness = s.f64(columns::drag_stiffness).data();
  for (size_t k = 0; k < ids.size(); ++k) {
    if (!id || ids[k] == *id) continue;
    ids[kept] = ids[k];
    store3(target, kept, load3(target, k));
    stiffness[kept++] = stiffness[k];
  }
  for (const auto c : {columns::drag_id, columns::drag_target, columns::drag_stiffness}) s.resize(c, kept);
}

}  // namespace

/// The command's row, refused unless forces move that body.
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
      const size_t i = checked_body(s, c), k = s.rows(columns::push_id);
      for (const auto column : {columns::push_id, columns::push_force, columns::push_remaining})
        s.resize(column, k + 1);
      s.span<uint64_t>(columns::push_id)[k] = s.span<uint64_t>(columns::id)[i];
      store3(s.f64(columns::push_force).data(), k, c.vector);
      s.f64(columns::push_remaining)[k] = c.duration;
      return wake_body(s, i, bodies_.kinds);
    }
    case CommandKind::impulse: {
      const size_t i = checked_body(s, c);
      double* v = s.f64(columns::velocity).data();
      store3(v, i, load3(v, i) + c.vector / bodies_.kinds[s.span<uint32_t>(columns::kind)[i]].mass);
      return wake_body(s, i, bodies_.kinds);
    }
    case CommandKind::drag: {
      const size_t i = checked_body(s, c);
      if (c.value < 0) refuse_command("value", "out_of_range", "the stiffness must be at least 0");
      const uint64_t id = s.span<uint64_t>(columns::id)[i];
      end_drags(s, id);
      const size_t k = s.rows(columns::drag_id);
      for (const auto column : {columns::drag_id, columns::drag_target, columns::drag_stiffness})
        s.resize(column, k + 1);
      s.span<uint64_t>(columns::drag_id)[k] = id;
      store3(s.f64(columns::drag_target).data(), k, c.vector);
      // 100 m: a period of 0.6 s.
      const double mass = bodies_.kinds[s.span<uint32_t>(columns::kind)[i]].mass;
      s.f64(columns::drag_stiffness)[k] = c.value > 0 ? c.value : 100 * mass;
      return wake_body(s, i, bodies_.kinds);
    }
    case CommandKind::release:
      return end_drags(
          s, c.index == -1 ? std::nullopt : std::optional(s.span<uint64_t>(columns::id)[checked_body(s, c)]));
    case CommandKind::spawn: {
      if (s.rows(columns::position) >= most_bodies_) {
        refuse_command("kind", "full", "the system holds its largest number of bodies",
                       std::to_string(most_bodies_));
      }
      // "name" is the id of an entry of "bodies"; without one the last dynamic entry is taken.
      std::optional<uint32_t> chosen;
      for (uint32_t k = 0; k < bodies_.kinds.size(); ++k) {
        const BodyKind& b = bodies_.kinds[k];
        if (c.name.empty() ? b.moved_by_forces() : b.id == c.name) chosen = k;
      }
      if (!chosen) refuse_command("name", "unknown_body", "no entry of bodies has the id \"" + c.name + "\"");
      return append_body(s, {*chosen, bodies_.kinds[*chosen].body_pose({c.vector, {}}), c.velocity, {}});
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
  refuse_command("kind", "unsupported_command", "bodies cannot be pinned; drag one instead",
                 "push, impulse, drag, release, spawn, remove, set_parameter");
}

void Rigid3d::set_parameter(State& s, const Command& c) const {
  const auto wake_all = [&] {
    for (size_t i = 0; i < s.rows(columns::asleep); ++i) {
      s.span<uint32_t>(columns::asleep)[i] = 0, s.f64(columns::calm_time)[i] = 0;
    }
  };
  if (c.name == "gravity") {
    store3(s.f64(columns::gravity).data(), 0, c.vector);
    return wake_all();
  }
  if (c.name == "motor_speed" || c.name == "motor_target" || c.name == "max_motor") return set_motor(s, c);
  const bool turn = c.name == "angular_velocity";
  if (!turn && c.name != "velocity") {
    refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                   "gravity, velocity, angular_velocity, motor_speed, motor_target, max_motor");
  }
  const size_t i = checked_command_row(c, s.rows(columns::position), "body");
  const BodyKind& b = bodies_.kinds[s.span<uint32_t>(columns::kind)[i]];
  if (b.motion == BodyDef::Motion::fixed) {
    refuse_command("index", "not_movable", "body " + std::to_string(i) + " is fixed",
                   "a dynamic or kinematic body");
  }
  store3(s.f64(turn ? columns::angular_velocity : columns::velocity).data(), i, c.vector);
  if (b.moved_by_forces()) wake_body(s, i, bodies_.kinds);
}

}  // namespace truestep
