// A rigid3d scene stepped by Bullet 3.24: same state, fields, observables and commands as our own system,
// another solver (sequential impulses, ten iterations a step, implicit gyroscopic term; substeps, softness
// of contacts and precision of the scene do not apply). What Bullet remembers of contacts lies in the
// workspace: whenever the state is not the one that the last step wrote (a command moved something, a
// snapshot was restored, the workspace was dropped), its world is built again from poses and velocities, and
// contacts start without the impulses of the step before.
// Source: E. Coumans, Bullet Physics SDK 3.24 (zlib licence).
#pragma once
#include <memory>

#include "engine/core/build.h"
#include "engine/core/system.h"
#include "engine/systems/rigid3d/rigid3d_def.h"

namespace truestep {

/// Error "scene_invalid" with pointers for what Bullet has no equivalent of.
std::unique_ptr<const System> build_bullet(const rigid3d::Rigid3dDef& def, const BuildContext& context);

}  // namespace truestep
