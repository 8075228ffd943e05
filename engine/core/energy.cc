#include "engine/core/energy.h"

#include <algorithm>
#include <cmath>

namespace truestep {

void EnergyWatch::begin(const Energy& e) {
  reference = e.kinetic + e.potential;
  // The zero of a potential is arbitrary: if it is far away, the check is merely less strict.
  available = std::max(available, e.kinetic + std::abs(e.potential));
  phase = e.exchange == Energy::Exchange::closed ? Phase::watching : Phase::open;
}

void EnergyWatch::command(const Energy& before, const Energy& after) {
  if (phase == Phase::fresh) return;
  const double work = (after.kinetic + after.potential) - (before.kinetic + before.potential);
  reference += work;
  available = std::max({available, std::abs(work), std::abs(after.kinetic - before.kinetic)});
}

bool EnergyWatch::holds(const Energy& now) {
  if (phase != Phase::watching || now.exchange == Energy::Exchange::open) return begin(now), true;
  // For a closed system this is what the potential has given or taken so far.
  const double potential = now.potential - now.residual;
  available = std::max(available, reference - potential);
  const double gain = now.kinetic + potential - reference;
  // For things at rest whose energy is all rounding.
  constexpr double kRounding = 1e-9;
  return gain <= std::max(kRounding, now.swing * std::max(available, now.slack));
}

}  // namespace truestep
