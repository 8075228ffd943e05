// How commands change an xpbd state; errors name the member of the command that is wrong.
#include <algorithm>

#include "engine/core/commands/point_commands.h"
#include "engine/systems/xpbd/xpbd.h"

namespace truestep::xpbd {

using Columns = XpbdColumns;

namespace {

constexpr PointCommands kPoints({Columns::velocity, Columns::inverse_mass, Columns::kHands}, "point",
                                "points of cloth and ropes cannot be added or removed");

}  // namespace

void Xpbd::apply(State& s, const Command& c) const {
  const auto stiffness = [&](size_t row) { return default_drag(s, row); };
  if (!kPoints.apply(s, c, masses(s), stiffness)) set_parameter(s, c);
}

double Xpbd::default_drag(const State& s, size_t row) const {
  // As stiff as the stiffest link at the point, so that it follows the hand.
  double k = 0;
  if (tears_) row = s.span<uint32_t>(tears_->columns.origin)[row];
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
  if (cosserat_ && (c.name == "stiffness" || c.name == "shear_stiffness" || c.name == "youngs_modulus")) {
    refuse_command("name", "unknown_parameter", "the moduli of rods cannot change during a run");
  }
  const bool rods = !body_.rods.empty() && body_.triangles.empty();
  const bool plates =
      !body_.triangles.empty() && !(body_.rods.empty() && body_.hinges.empty() && body_.angles.empty());
  if (!matches_.empty() && (c.name == "stiffness" || c.name == "bulk_modulus")) {
    refuse_command("name", "unknown_parameter", "a body with matching has neither links nor volumes");
  }
  if (c.name == "stiffness") return set(Family::structural, !youngs_);
  if (c.name == "shear_stiffness") return set(Family::shear, !youngs_ && has(Family::shear));
  if (elastic_ && c.name == "youngs_modulus") return set(Family::volume, true);
  if (c.name == "youngs_modulus") {
    set(Family::structural, youngs_);
    stiffness[static_cast<size_t>(Family::shear)] = c.value;
    return;
  }
  if (c.name == "bending_rigidity") return set(Family::bending, rods);
  if (c.name == "flexural_rigidity") return set(Family::bending, plates);
  if (c.name == "bulk_modulus") return set(Family::volume, !body_.tetrahedra.empty() && !elastic_);
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
