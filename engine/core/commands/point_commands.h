// Commands for systems with a fixed number of points: push, impulse, drag, release, pin and unpin; errors
// name the offending member of the command.
#pragma once
#include <span>
#include <string_view>

#include "engine/core/commands/command_checks.h"
#include "engine/core/commands/user_forces.h"

namespace truestep {

class PointCommands {
 public:
  struct Columns {
    State::Column velocity, inverse_mass;
    UserForces hands;
  };
  /// `row` is what a row is called, "point"; `others` says why rows cannot be added or removed. `masses` (kg)
  /// are restored to unpinned rows.
  constexpr PointCommands(const Columns& columns, std::string_view row, std::string_view others)
      : columns_(columns), row_(row), others_(others) {}

  /// Row of the command. Error: no such row.
  size_t row(const State& s, const Command& c) const;
  /// Returns false for set_parameter, which is left to the system. `stiffness(row)` (N/m) is the default
  /// stiffness of a drag.
  template <class Stiffness>
  bool apply(State& s, const Command& c, std::span<const double> masses, const Stiffness& stiffness) const {
    check(c);
    if (c.kind == CommandKind::set_parameter) return false;
    if (c.kind == CommandKind::drag) {
      const size_t i = row(s, c);
      columns_.hands.set_drag(s, i, c.vector, c.value > 0 ? c.value : stiffness(i), std::nullopt);
      return true;
    }
    apply_at_once(s, c, masses);
    return true;
  }

 private:
  void check(const Command& c) const;
  void apply_at_once(State& s, const Command& c, std::span<const double> masses) const;

  Columns columns_;
  std::string_view row_, others_;
};

}  // namespace truestep
