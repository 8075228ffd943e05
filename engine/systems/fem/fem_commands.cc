// What commands do to a body of finite elements; errors name the member of the command that is wrong.
#include <algorithm>

#include "engine/core/command_checks.h"
#include "engine/math/trig.h"
#include "engine/systems/fem/fem.h"

namespace truestep::fem {

using Columns = FemColumns;

void Fem::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  refuse_place(c, "node");
  if (c.value < 0) refuse_command("value", "out_of_range", "the value must be at least 0");
  const auto row = [&] { return checked_command_row(c, s.rows(Columns::inverse_mass), "node"); };
  const auto plane = [&] {
    if (body().plane && c.vector.z != 0)
      refuse_command("vector", "out_of_range", "a plane body stays in z = 0");
  };
  const auto w = s.f64(Columns::inverse_mass);
  double* v = s.f64(Columns::velocity).data();
  switch (c.kind) {
    case CommandKind::push:
      plane();
      return Columns::kHands.add_push(s, {row(), c.vector, {}}, c.duration);
    case CommandKind::impulse: {
      plane();
      const size_t i = row();
      double dv[3] = {c.vector.x, c.vector.y, c.vector.z};
      for (size_t k = 0; k < 3; ++k) {
        if (body().axes[i] >> k & 1) dv[k] = 0;
      }
      return store3(v, i, load3(v, i) + w[i] * Vec3{dv[0], dv[1], dv[2]});
    }
    case CommandKind::drag: {
      plane();
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
      if (body().axes[i] == 7) refuse_command("index", "held", "the scene's holds keep this node");
      w[i] = 1 / body().masses[i];
      return;
    }
    case CommandKind::set_parameter:
      break;
    case CommandKind::spawn:
    case CommandKind::remove:
      refuse_command("kind", "unsupported_command", "a body of elements keeps its nodes",
                     "push, impulse, drag, release, pin, unpin, set_parameter");
  }
  if (c.name == "gravity") {
    plane();
    return store3(s.f64(Columns::gravity).data(), 0, c.vector);
  }
  if (c.name == "youngs_modulus") {
    if (!(c.value > 0)) refuse_command("value", "out_of_range", "Young's modulus must be above 0");
    s.f64(Columns::parameters)[0] = c.value;
    return;
  }
  if (c.name == "damping") {
    if (elements_.dependence() == Dependence::position) {
      refuse_command("name", "unknown_parameter",
                     "this scene began without damping, which its method relies on");
    }
    s.f64(Columns::parameters)[1] = c.value;
    return;
  }
  refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                 "youngs_modulus, damping, gravity");
}

double Fem::default_drag(const State& s, size_t row) const {
  // As stiff as a cube of the material of the node's share of volume.
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
