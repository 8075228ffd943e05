#include "engine/scene/catalogue.h"

#include "engine/systems/oscillator/oscillator.h"
#include "engine/systems/particles/particles.h"
#include "engine/systems/pendulum/pendulum.h"

namespace truestep {

std::span<const CatalogueRow> catalogue() {
  static const std::vector<CatalogueRow> kRows = {
      {"oscillator",
       "equations",
       "a damped, driven mass on a spring with its exact solution",
       &oscillator_table(),
       make_oscillator,
       cost_oscillator,
       {"every integrator shows its order on it", "the amplitude per step is the method's own, to 1e-12"},
       "rk4"},
      {"pendulum",
       "equations",
       "a chain of point masses on rigid rods that swings in a plane",
       &pendulum_table(),
       make_pendulum,
       cost_pendulum,
       {"follows the published simple and double pendulum to 1e-8", "keeps its energy when undamped"},
       "rk4"},
      {"particles",
       "points",
       "points with emitters, lifetimes, forces and obstacles",
       &particles_table(),
       build_particles,
       particles_cost,
       {"a birth is a function of seed, emitter and number alone, at its exact time between steps",
        "no point passes a collider, however thin or fast", "points at rest stay at rest to the bit"},
       "leapfrog"},
  };
  return kRows;
}

const CatalogueRow* find_system_type(std::string_view type) {
  for (const CatalogueRow& row : catalogue()) {
    if (row.type == type) return &row;
  }
  return nullptr;
}

}  // namespace truestep
