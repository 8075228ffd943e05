// How commands change a mass_spring state; errors name the member of the command that is wrong.
#include <algorithm>
#include <cmath>

#include "engine/core/commands/point_commands.h"
#include "engine/systems/mass_spring/mass_spring.h"

namespace truestep::mass_spring {

using Columns = MassSpringColumns;

namespace {

constexpr PointCommands kPoints({Columns::velocity, Columns::inverse_mass, Columns::kHands}, "point",
                                "points of a spring network cannot be added or removed");

}  // namespace

void MassSpring::apply(State& s, const Command& c) const {
  const auto stiffness = [&](size_t row) { return default_drag(s, row); };
  if (!kPoints.apply(s, c, springs_.masses(), stiffness)) set_parameter(s, c);
}

double MassSpring::default_drag(const State& s, size_t row) const {
  // As stiff as the stiffest spring at the point: it follows the hand and does not require a smaller step.
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
