// The coupling type "immersion": rigid bodies of a in b, a medium that takes bodies (core/ports/medium.h).
// Within its step the medium moves them by its own pressure and by their acceleration in the previous step;
// at the step's end the bodies receive the medium's impulses and the resulting displacements. Until then they
// fall, and meet other bodies, as if the medium did what it did in the previous step: a step must be too
// short to fall far in (stable_h).
#pragma once
#include <memory>

#include "engine/core/coupling.h"
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"

namespace truestep::immersion {

struct ImmersionDef {
  enum class Which : uint8_t { moving, all } bodies = Which::moving;
};

const DefTable& immersion_table();
Cost immersion_cost(const void* def, const Cost& a, const Cost& b);
/// Error "scene_invalid" when a has no bodies in space or b is not a medium in space.
std::unique_ptr<const Coupling> build_immersion(const void* def, const CouplingContext& context);

}  // namespace truestep::immersion
