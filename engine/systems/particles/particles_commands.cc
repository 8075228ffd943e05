// Commands on a particles state; errors name the offending member of the command. A row given by a command is
// remembered by its id, since rows move when particles die.
#include <algorithm>
#include <cmath>

#include "engine/core/commands/command_checks.h"
#include "engine/systems/particles/boris.h"
#include "engine/systems/particles/particles.h"

namespace truestep::particles {

namespace {

size_t checked_row(const State& s, const Command& c) {
  return checked_command_row(c, s.rows(columns::position), "particle");
}

uint64_t id_of(const State& s, size_t row) {
  return s.span<uint64_t>(columns::id)[row];
}

/// System-wide parameters that set_parameter changes.
struct Settable {
  std::string_view name;
  Parameter place;
  enum class Kind : uint8_t { any_number, not_negative, vector } kind;
};
constexpr Settable kSettable[] = {
    {"gravity", Parameter::gravity, Settable::Kind::vector},
    {"wind", Parameter::wind, Settable::Kind::vector},
    {"electric_field", Parameter::electric_field, Settable::Kind::vector},
    {"magnetic_field", Parameter::magnetic_field, Settable::Kind::vector},
    {"linear_drag", Parameter::linear_drag, Settable::Kind::not_negative},
    {"quadratic_drag", Parameter::quadratic_drag, Settable::Kind::not_negative},
    {"thrust", Parameter::thrust, Settable::Kind::any_number},
};

}  // namespace

void Particles::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  refuse_place(c, "particle");
  switch (c.kind) {
    case CommandKind::push:
      return columns::kHands.add_push(s, {id_of(s, checked_row(s, c)), c.vector, {}}, c.duration);
    case CommandKind::impulse: {
      const size_t i = checked_row(s, c);
      double* v = s.f64(columns::velocity).data();
      return store3(v, i, load3(v, i) + c.vector / s.f64(columns::mass)[i]);
    }
    case CommandKind::drag: {
      const size_t i = checked_row(s, c);
      if (c.value < 0) refuse_command("value", "out_of_range", "the stiffness must be at least 0");
      // 100 N/m per kg: a period of 0.6 s, soft enough for every step that draws smoothly.
      return columns::kHands.set_drag(s, id_of(s, i), c.vector,
                                      c.value > 0 ? c.value : 100 * s.f64(columns::mass)[i], std::nullopt);
    }
    case CommandKind::release:
      return columns::kHands.release(
          s, c.index == -1 ? std::nullopt : std::optional(id_of(s, checked_row(s, c))));
    case CommandKind::spawn: {
      if (s.rows(columns::position) >= particles_.capacity()) {
        refuse_command("type", "full", "the system has reached its largest number of particles",
                       std::to_string(particles_.capacity()));
      }
      append_particle(s, {c.vector, c.velocity, particles_.def().mass, s.f64(columns::time)[0],
                          std::numeric_limits<double>::infinity(), particles_.def().charge});
      ++s.span<uint64_t>(columns::counters)[static_cast<size_t>(Counter::emitted)];
      return;
    }
    case CommandKind::remove: {
      std::vector<uint8_t> dead(s.rows(columns::position));
      dead[checked_row(s, c)] = 1;
      Workspace workspace;
      remove_rows(s, dead, workspace);
      ++s.span<uint64_t>(columns::counters)[static_cast<size_t>(Counter::killed)];
      return;
    }
    case CommandKind::set_parameter:
      return set_parameter(s, c);
    case CommandKind::pin:
    case CommandKind::unpin:
      break;
  }
  refuse_command("type", "unsupported_command", "particles cannot be pinned; drag one instead",
                 "push, impulse, drag, release, spawn, remove, set_parameter");
}

void Particles::set_parameter(State& s, const Command& c) const {
  std::string allowed;
  for (const Settable& p : kSettable) {
    allowed += std::string(p.name) + ", ";
    if (p.name != c.name) continue;
    const bool drag = p.place == Parameter::linear_drag || p.place == Parameter::quadratic_drag;
    if (drag && c.value != 0 && integrator().name == kBorisName) {
      refuse_command("value", "out_of_range", "the integrator boris does not support drag", "0");
    }
    double* place = s.f64(columns::parameters).data() + static_cast<size_t>(p.place);
    if (p.kind == Settable::Kind::vector) return store3(place, 0, c.vector);
    if (p.kind == Settable::Kind::not_negative && c.value < 0) {
      refuse_command("value", "out_of_range", c.name + " must be at least 0", "at least 0");
    }
    *place = c.value;
    return;
  }
  // "restitution" and "friction" refer to all colliders, "<id>.restitution" to one.
  const size_t dot_at = c.name.rfind('.');
  const std::string id = dot_at == std::string::npos ? "" : c.name.substr(0, dot_at);
  const std::string what = dot_at == std::string::npos ? c.name : c.name.substr(dot_at + 1);
  const auto& colliders = particles_.colliders().colliders();
  double* surface = s.f64(columns::surfaces).data();
  bool found = false;
  for (size_t k = 0; k < colliders.size(); ++k) {
    if (!id.empty() && colliders[k].id != id) continue;
    if (what != "restitution" && what != "friction") continue;
    if (c.value < 0 || (what == "restitution" && c.value > 1)) {
      refuse_command("value", "out_of_range", what + " is out of range",
                     what == "friction" ? "at least 0" : "0 to 1");
    }
    surface[3 * k + (what == "friction")] = c.value;
    found = true;
  }
  if (!found) {
    refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                   allowed + "restitution, friction, <collider>.restitution, <collider>.friction");
  }
}

}  // namespace truestep::particles
