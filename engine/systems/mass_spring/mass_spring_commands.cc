// What commands do to a mass_spring state; errors name the member of the command that is wrong.
#include <algorithm>
#include <cmath>

#include "engine/core/command_checks.h"
#include "engine/systems/mass_spring/mass_spring.h"

namespace truestep::mass_spring {

using Columns = MassSpringColumns;

void MassSpring::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  refuse_place(c, "point");
  if (c.value < 0) refuse_command("value", "out_of_range", "the value must be at least 0");
  const auto row = [&] { return checked_command_row(c, s.rows(Columns::inverse_mass), "point"); };
  const auto w = s.f64(Columns::inverse_mass);
  double* v = s.f64(Columns::velocity).data();
  switch (c.kind) {
    case CommandKind::push:
      return Columns::kHands.add_push(s, {row(), c.vector, {}}, c.duration);
    case CommandKind::impulse: {
      const size_t i = row();
      return store3(v, i, load3(v, i) + w[i] * c.vector);
    }
    case CommandKind::drag: {
      const size_t i = row();
      return Columns::kHands.set_drag(s, i, c.vector, c.value > 0 ? c.value : default_drag(s, i),
                                      std::nullopt);
    }
    case CommandKind::release:
      return Columns::kHands.release(s, c.index == -1 ? std::nullopt : std::optional<uint64_t>(row()));
    case CommandKind::pin: {
      const size_t i = row();
      w[i] = 0;
      return store3(v, i, Vec3{});
    }
    case CommandKind::unpin: {
      const size_t i = row();
      w[i] = 1 / springs_.masses()[i];
      return;
    }
    case CommandKind::set_parameter:
      return set_parameter(s, c);
    case CommandKind::spawn:
    case CommandKind::remove:
      break;
  }
  refuse_command("kind", "unsupported_command", "a network of springs keeps its points",
                 "push, impulse, drag, release, pin, unpin, set_parameter");
}

double MassSpring::default_drag(const State& s, size_t row) const {
  // As stiff as the stiffest spring at the point: it follows the hand and asks for no smaller step.
  const SpringSchedule& schedule = springs_.schedule();
  double k = 0;
  for (size_t i = 0; i < schedule.a.size(); ++i) {
    if (schedule.a[i] != row && schedule.b[i] != row) continue;
    k = std::max(k, schedule.scale[i] * s.f64(Columns::stiffness)[static_cast<size_t>(schedule.family[i])]);
  }
  return k > 0 ? k : 100 * springs_.masses()[row];
}

void MassSpring::set_parameter(State& s, const Command& c) const {
  const auto families = springs_.schedule().family;
  const auto set_stiffness = [&](SpringFamily family) {
    if (std::find(families.begin(), families.end(), family) == families.end()) {
      refuse_command("name", "unknown_parameter", "this scene has no such springs");
    }
    s.f64(Columns::stiffness)[static_cast<size_t>(family)] = c.value;
  };
  const auto needs_velocity = [&] {
    if (springs_.dependence() == Dependence::position && integrator().order_with_velocity == 0) {
      refuse_command("name", "unsuitable_integrator",
                     std::string(integrator().name) + " cannot follow forces that depend on velocity");
    }
  };
  if (c.name == "stiffness") return set_stiffness(SpringFamily::structural);
  if (c.name == "shear_stiffness") return set_stiffness(SpringFamily::shear);
  if (c.name == "bending_stiffness") return set_stiffness(SpringFamily::bending);
  if (c.name == "gravity") return store3(s.f64(Columns::gravity).data(), 0, c.vector);
  if (c.name == "damping" || c.name == "internal_damping") {
    if (c.value > 0) needs_velocity();
    s.f64(Columns::damping)[c.name == "damping" ? 0 : 1] = c.value;
    return;
  }
  if (c.name == "wind") {
    needs_velocity();
    store3(s.f64(Columns::wind).data(), 0, c.vector);
    s.span<uint32_t>(Columns::air)[0] = 1;
    return;
  }
  refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                 "stiffness, shear_stiffness, bending_stiffness, damping, internal_damping, gravity, wind");
}

}  // namespace truestep::mass_spring
