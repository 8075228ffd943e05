// What a state from outside may contain: particles up to the reserved capacity, springs between existing
// particles, and emitters that are not far behind the simulated time.
#include "engine/systems/particles/emission.h"
#include "engine/systems/particles/particles.h"
#include "engine/systems/particles/particles_state.h"

namespace truestep::particles {

void Particles::check(StateCheck& check, double t) const {
  constexpr uint64_t kMostBehind = 1000;  // births; a run leaves none behind except by rounding
  const State& s = check.state();
  check.together(columns::position, columns::per_particle_end, particles_.capacity())
      .together({columns::spring_rows, columns::spring_values}, particles_.def().springs.size())
      .together({columns::push_id, columns::push_force, columns::push_remaining})
      .together({columns::drag_id, columns::drag_target, columns::drag_stiffness});
  if (has_charges(s)) check.together({columns::position, columns::charge});
  for (const uint32_t row : s.span<uint32_t>(columns::spring_rows))
    check.require(row < s.rows(columns::position), "spring.rows");
  const auto next = s.span<uint64_t>(columns::next_particle);
  const auto& emitters = particles_.def().emitters;
  check.require(next.size() == emitters.size(), "emitters");
  for (size_t k = 0; k < emitters.size(); ++k) {
    const bool near = next[k] <= UINT64_MAX / 2 && birth_time(emitters[k], next[k] + kMostBehind) >= t;
    check.require(near, "an emitter is far behind the simulated time");
  }
}

}  // namespace truestep::particles
