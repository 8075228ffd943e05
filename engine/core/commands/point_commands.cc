#include "engine/core/commands/point_commands.h"

namespace truestep {

size_t PointCommands::row(const State& s, const Command& c) const {
  return checked_command_row(c, s.rows(columns_.inverse_mass), std::string(row_));
}

void PointCommands::check(const Command& c) const {
  check_command_numbers(c);
  refuse_place(c, std::string(row_));
  if (c.value < 0) refuse_command("value", "out_of_range", "the value must be at least 0");
}

void PointCommands::apply_at_once(State& s, const Command& c, std::span<const double> masses) const {
  const auto w = s.f64(columns_.inverse_mass);
  double* v = s.f64(columns_.velocity).data();
  switch (c.kind) {
    case CommandKind::push:
      return columns_.hands.add_push(s, {row(s, c), c.vector, {}}, c.duration);
    case CommandKind::impulse: {
      const size_t i = row(s, c);
      return store3(v, i, load3(v, i) + w[i] * c.vector);
    }
    case CommandKind::release:
      return columns_.hands.release(s, c.index == -1 ? std::nullopt : std::optional<uint64_t>(row(s, c)));
    case CommandKind::pin: {
      const size_t i = row(s, c);
      w[i] = 0;
      return store3(v, i, Vec3{});
    }
    case CommandKind::unpin: {
      const size_t i = row(s, c);
      w[i] = 1 / masses[i];
      return;
    }
    default:
      refuse_command("type", "unsupported_command", std::string(others_),
                     "push, impulse, drag, release, pin, unpin, set_parameter");
  }
}

}  // namespace truestep
