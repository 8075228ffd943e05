// What a system's energy says about its steps. Energy that nothing brought in is the surest sign of a method
// beyond its limit, long before numbers overflow.
#pragma once
#include <algorithm>
#include <cstdint>

namespace truestep {

struct Energy {
  double kinetic = 0, potential = 0;  ///< J
  /// Whether anything but commands can do work on the system in this state: drives, wind, obstacles that move
  /// or that put points back out of themselves, emitters, a push that lasts. Of an open system only whether
  /// its energies are finite is known.
  enum class Exchange : uint8_t { open, closed } exchange = Exchange::open;
  /// J that a sound step may add without a cause: what putting overlapping bodies apart lifts.
  double slack = 0;
  /// Times the energy that is available that the method's own swings may reach: explicit methods with a
  /// limit omega h < 2 swing by (2 + omega h) / (2 - omega h), so up to 0.998 of the limit are left alone.
  double swing = kSwing;

  static constexpr double kSwing = 10, kSwingNearLimit = 1000;
};

/// Limit for a system in which `speed` is the fastest that its start could give: a thousand times that, and
/// at least a thousand times orbital speed, because a scene at rest may be kicked by commands.
inline double unexplained_speed(double speed) {
  constexpr double kMargin = 1000, kOrbital = 1e4;
  return kMargin * std::max(speed, kOrbital);
}

/// What is remembered of a closed system's energy from check to check. Part of the world's state: a restored
/// run is judged like the one that it continues.
struct EnergyWatch {
  double reference = 0;  ///< J, at the start, plus what commands have done since
  double available = 0;  ///< J, largest amount seen to change hands
  enum class Phase : uint8_t { fresh, open, watching } phase = Phase::fresh;
  friend bool operator==(const EnergyWatch&, const EnergyWatch&) = default;

  /// Takes the present energy for the reference.
  void begin(const Energy& e);
  /// The energy after a command, before and after.
  void command(const Energy& before, const Energy& after);
  /// False when the energy has risen beyond what could have been available. Open systems begin afresh.
  bool holds(const Energy& now);
};

}  // namespace truestep
