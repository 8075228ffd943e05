// Checks the steps of a system by its energy. An unexplained gain of energy is the surest sign of a method
// beyond its limit, long before numbers overflow.
#pragma once
#include <algorithm>
#include <cstdint>

namespace truestep {

struct Energy {
  double kinetic = 0, potential = 0;  ///< J
  /// Whether anything other than commands can do work on the system in this state: drives, wind, obstacles
  /// that move or push points out, emitters, a lasting push. For an open system, only the finiteness of its
  /// energies is checked.
  enum class Exchange : uint8_t { open, closed } exchange = Exchange::open;
  /// J that a sound step may add without a cause: the lift when overlapping bodies are separated.
  double slack = 0;
  /// Factor of the available energy that the method's own oscillation may reach: explicit methods with a
  /// limit omega h < 2 oscillate by (2 + omega h) / (2 - omega h), so up to 0.998 of the limit passes.
  double swing = kSwing;
  /// J of the potential that motion may not have put in: stretch of stiff links that sweeps have left. By
  /// itself a system is judged without it, joined to others with it.
  double residual = 0;

  static constexpr double kSwing = 10, kSwingNearLimit = 1000;
};

/// Speed limit for a system in which `speed` is the fastest that its initial state could produce: a thousand
/// times that, and at least a thousand times orbital speed, because commands may kick a scene at rest.
inline double unexplained_speed(double speed) {
  constexpr double kMargin = 1000, kOrbital = 1e4;
  return kMargin * std::max(speed, kOrbital);
}

/// What is remembered of a closed system's energy from check to check. Part of the world's state: a restored
/// run is judged like the one it continues.
struct EnergyWatch {
  double reference = 0;  ///< J, at the start, plus what commands have done since
  double available = 0;  ///< J, largest amount observed to change hands
  enum class Phase : uint8_t { fresh, open, watching } phase = Phase::fresh;
  friend bool operator==(const EnergyWatch&, const EnergyWatch&) = default;

  /// Takes the present energy as the reference.
  void begin(const Energy& e);
  /// The energy after a command, before and after.
  void command(const Energy& before, const Energy& after);
  /// False when the energy has risen beyond what could have been available. Open systems start afresh.
  bool holds(const Energy& now);
};

}  // namespace truestep
