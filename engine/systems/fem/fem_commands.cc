// How commands change a body of finite elements; errors name the member of the command that is wrong.
#include <algorithm>

#include "engine/core/commands/point_commands.h"
#include "engine/math/trig.h"
#include "engine/systems/fem/fem.h"

namespace truestep::fem {

using Columns = FemColumns;

namespace {

constexpr PointCommands kNodes({Columns::velocity, Columns::inverse_mass, Columns::kHands}, "node",
                               "nodes of a finite-element body cannot be added or removed");

}  // namespace

void Fem::apply(State& s, const Command& given) const {
  Command c = given;
  if (body().plane && c.vector.z != 0)
    refuse_command("vector", "out_of_range", "a plane body must stay in z = 0");
  if (c.kind == CommandKind::unpin && body().axes[kNodes.row(s, c)] == 7) {
    refuse_command("index", "held", "this node is fixed by the scene's holds");
  }
  if (c.kind == CommandKind::impulse) {
    const uint8_t held = body().axes[kNodes.row(s, c)];
    c.vector = {held & 1 ? 0 : c.vector.x, held & 2 ? 0 : c.vector.y, held & 4 ? 0 : c.vector.z};
  }
  const auto stiffness = [&](size_t row) { return default_drag(s, row); };
  if (kNodes.apply(s, c, body().masses, stiffness)) return;
  if (c.name == "gravity") return store3(s.f64(Columns::gravity).data(), 0, c.vector);
  if (c.name == "youngs_modulus") {
    if (!(c.value > 0)) refuse_command("value", "out_of_range", "Young's modulus must be above 0");
    s.f64(Columns::parameters)[0] = c.value;
    return;
  }
  if (c.name == "damping") {
    if (elements_.dependence() == Dependence::position) {
      refuse_command("name", "unknown_parameter",
                     "this scene started without damping, and its method relies on that");
    }
    s.f64(Columns::parameters)[1] = c.value;
    return;
  }
  refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                 "youngs_modulus, damping, gravity");
}

double Fem::default_drag(const State& s, size_t row) const {
  // As stiff as a cube of the material with the node's share of volume.
  double volume = 0;
  for (size_t k = 0; k < body().mesh.cells(); ++k) {
    const auto nodes = body().mesh.cell(k);
    if (std::find(nodes.begin(), nodes.end(), row) == nodes.end()) continue;
    const CellRule rule = elements_.rule(k);
    for (size_t q = 0; q < rule.points; ++q) volume += rule.weights[q] / static_cast<double>(rule.nodes);
  }
  return s.f64(Columns::parameters)[0] * trig::pow(volume, 1.0 / 3);
}

}  // namespace truestep::fem
