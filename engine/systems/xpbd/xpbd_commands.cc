// What commands do to an xpbd state; errors name the member of the command that is wrong.
#include <algorithm>

#include "engine/core/command_checks.h"
#include "engine/systems/xpbd/xpbd.h"

namespace truestep::xpbd {

using Columns = XpbdColumns;

void Xpbd::apply(State& s, const Command& c) const {
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
      w[i] = 1 / body_.masses[i];
      return;
    }
    case CommandKind::set_parameter:
      return set_parameter(s, c);
    case CommandKind::spawn:
    case CommandKind::remove:
      break;
  }
  refuse_command("kind", "unsupported_command", "a cloth or a rope keeps its points",
                 "push, impulse, drag, release, pin, unpin, set_parameter");
}

double Xpbd::default_drag(const State& s, size_t row) const {
  // As stiff as the stiffest link at the point, so that it follows the hand.
  double k = 0;
  for (const Link& l : body_.links) {
    if (l.a != row && l.b != row) continue;
    k = std::max(k, s.f64(Columns::stiffness)[static_cast<size_t>(l.family)] * l.factor);
  }
  return k > 0 ? k : 100 * body_.masses[row];
}

void Xpbd::set_parameter(State& s, const Command& c) const {
  const auto stiffness = s.f64(Columns::stiffness);
  const auto set = [&](Family family, bool there) {
    if (!there) refuse_command("name", "unknown_parameter", "this scene has no such constraints");
    stiffness[static_cast<size_t>(family)] = c.value;
  };
  const auto has = [&](Family family) {
    return std::any_of(body_.links.begin(), body_.links.end(), [&](auto& l) { return l.family == family; });
  };
  const bool rods = !body_.rods.empty() && body_.triangles.empty();
  const bool plates =
      !body_.triangles.empty() && !(body_.rods.empty() && body_.hinges.empty() && body_.angles.empty());
  if (c.name == "stiffness") return set(Family::structural, !youngs_);
  if (c.name == "shear_stiffness") return set(Family::shear, !youngs_ && has(Family::shear));
  if (c.name == "youngs_modulus") {
    set(Family::structural, youngs_);
    stiffness[static_cast<size_t>(Family::shear)] = c.value;
    return;
  }
  if (c.name == "bending_rigidity") return set(Family::bending, rods);
  if (c.name == "flexural_rigidity") return set(Family::bending, plates);
  if (c.name == "bulk_modulus") return set(Family::volume, !body_.tetrahedra.empty());
  if (c.name == "wind") {
    if (!air_)
      refuse_command("name", "unknown_parameter", "this scene has no air",
                     "wind in the scene, 0 for still air");
    return store3(s.f64(Columns::wind).data(), 0, c.vector);
  }
  if (c.name == "gravity") return store3(s.f64(Columns::gravity).data(), 0, c.vector);
  if (c.name == "damping" || c.name == "internal_damping") {
    s.f64(Columns::damping)[c.name == "damping" ? 0 : 1] = c.value;
    return;
  }
  refuse_command(
      "name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
      "stiffness, shear_stiffness, youngs_modulus, bending_rigidity, flexural_rigidity, bulk_modulus, "
      "damping, internal_damping, gravity, wind");
}

}  // namespace truestep::xpbd
