#include "engine/systems/grid_fluid/steady/becomes_steady.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "engine/base/text/short_number.h"
#include "engine/systems/grid_fluid/grid_fluid_checks.h"

namespace truestep::grid_fluid {

namespace {

constexpr double kMostReynolds = 2000;

/// The largest speed of the walls; nothing if a side is open or its velocity is no number.
std::optional<double> speed_of_walls(const GridFluidDef& d) {
  double most = 0;
  for (size_t axis = 0; axis < d.cells.size(); ++axis) {
    for (size_t end = 0; end < 2; ++end) {
      const FlowSideDef& side = side_of(d, axis, end);
      if (side.kind != SideKind::wall && side.kind != SideKind::slip) return std::nullopt;
      for (const std::string& text : side.velocity) {
        char* rest = nullptr;
        const double value = std::strtod(text.c_str(), &rest);
        if (*rest != 0 || rest == text.c_str() || !std::isfinite(value)) return std::nullopt;
        most = std::max(most, std::abs(value));
      }
    }
  }
  return most;
}

}  // namespace

std::string steady_offer(const GridFluidDef& d) {
  if (d.steady() || d.liquid() || d.second_fluid || !d.force.empty() || d.vorticity_confinement != 0 ||
      d.order == GridFluidDef::Order::fourth)
    return "";
  const auto speed = speed_of_walls(d);
  if (!speed || !(*speed > 0)) return "";
  GridFluidDef found = d;
  found.stepping = GridFluidDef::Stepping::steady;
  found.viscous = GridFluidDef::Viscous::automatic;
  found.cfl.reset();
  found.initial.clear();
  found.advection = GridFluidDef::Advection::central;
  bool fits = true;
  check_flow(found, [&](const std::string&, const std::string&) { fits = false; });
  if (!fits) return "";
  double longest = 0;
  for (size_t axis = 0; axis < d.cells.size(); ++axis)
    longest = std::max(longest, axis < d.size.size() ? d.size[axis] : 1.0);
  const double reynolds = *speed * longest / d.viscosity;
  if (reynolds > kMostReynolds) return "";
  return "; at a Reynolds number of " + short_number(reynolds, 4) +
         " this flow becomes steady: stepping \"steady\" finds that state in the first step";
}

}  // namespace truestep::grid_fluid
