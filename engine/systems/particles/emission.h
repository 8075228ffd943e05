// Births. Particle n of an emitter is a pure function of (seed, emitter, n): its birth time is start + n /
// rate (bursts: their times), so a stream shows no bands however long the step is; its position, direction,
// speed and lifetime are counter-based draws.
#pragma once
#include <limits>

#include "engine/systems/particles/particles_def.h"

namespace truestep::particles {

/// Birth time (s) of particle n; infinity if the emitter has no such particle.
double birth_time(const EmitterDef& e, uint64_t n);

struct Birth {
  Vec3 x, v;
  double lifetime;  ///< s, infinity: for ever
};
/// Particle n of emitter number `emitter`.
Birth birth(const EmitterDef& e, uint64_t seed, uint64_t emitter, uint64_t n);

}  // namespace truestep::particles
