// Commands on bodies; errors name the offending member of the command. A body given by its row is remembered
// by its id, since rows move when bodies merge.
#include "engine/core/commands/command_checks.h"
#include "engine/systems/nbody/hermite.h"
#include "engine/systems/nbody/mercurius.h"
#include "engine/systems/nbody/nbody.h"

namespace truestep::nbody {

namespace {

/// Row of the command's body, which must have a mass.
size_t massive_row(const State& s, const Command& c) {
  const size_t i = checked_command_row(c, s.rows(Columns::position), "body");
  if (!(s.f64(Columns::mass)[i] > 0)) {
    refuse_command("index", "massless", "body " + std::to_string(i) + " has no mass: no force moves it",
                   "a body with a mass");
  }
  return i;
}

uint64_t id_of(const State& s, size_t row) {
  return s.span<uint64_t>(Columns::id)[row];
}

void set_parameter(State& s, const Command& c) {
  const bool constant = c.name == "gravitational_constant";
  if (!constant && c.name != "softening") {
    refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                   "gravitational_constant, softening");
  }
  if (c.value < 0) refuse_command("value", "out_of_range", c.name + " must be at least 0", "at least 0");
  const Parameter place = constant ? Parameter::gravitational_constant : Parameter::softening;
  s.f64(Columns::parameters)[static_cast<size_t>(place)] = c.value;
}

}  // namespace

void Nbody::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  refuse_place(c, "body");
  const std::string method(integrator().name);
  if ((method == kHermiteName || method == kMercuriusName) &&
      (c.kind == CommandKind::push || c.kind == CommandKind::drag)) {
    refuse_command("type", "unsupported_command",
                   "the integrator " + method + " supports no forces but gravity",
                   "impulse, release, set_parameter");
  }
  switch (c.kind) {
    case CommandKind::push:
      return Columns::kHands.add_push(s, {id_of(s, massive_row(s, c)), c.vector, {}}, c.duration);
    case CommandKind::impulse: {
      const size_t i = massive_row(s, c);
      double* v = s.f64(Columns::velocity).data();
      return store3(v, i, load3(v, i) + c.vector / s.f64(Columns::mass)[i]);
    }
    case CommandKind::drag: {
      const size_t i = massive_row(s, c);
      if (c.value < 0) refuse_command("value", "out_of_range", "the stiffness must be at least 0");
      if (c.value == 0) {
        // The natural time scale here cannot be known from outside.
        refuse_command("value", "missing", "a drag of a body needs a stiffness", "N/m, above 0");
      }
      return Columns::kHands.set_drag(s, id_of(s, i), c.vector, c.value, std::nullopt);
    }
    case CommandKind::release:
      return Columns::kHands.release(
          s, c.index == -1 ? std::nullopt : std::optional(id_of(s, massive_row(s, c))));
    case CommandKind::set_parameter:
      return set_parameter(s, c);
    default:
      break;
  }
  refuse_command("type", "unsupported_command", "bodies take push, impulse, drag and release",
                 "push, impulse, drag, release, set_parameter");
}

}  // namespace truestep::nbody
