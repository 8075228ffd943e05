// A rigid3d scene stepped by Bullet 3.24: same state, fields, observables and commands as our own system, but
// another solver (sequential impulses, ten iterations per step, implicit gyroscopic term; the scene's
// substeps, contact softness and precision do not apply). Bullet's contact cache lives in the workspace:
// whenever the state is not the one written by the last step (a command moved something, a snapshot was
// restored, the workspace was dropped), its world is rebuilt from poses and velocities, and contacts start
// without the impulses of the previous step.
// Source: E. Coumans, Bullet Physics SDK 3.24 (zlib licence).
#pragma once
#include <memory>

#include "engine/core/def/build.h"
#include "engine/core/system.h"
#include "engine/systems/rigid3d/rigid3d_def.h"

namespace truestep {

/// Error "scene_invalid" with pointers for everything that Bullet has no equivalent of.
std::unique_ptr<const System> build_bullet(const rigid3d::Rigid3dDef& def, const BuildContext& context);

}  // namespace truestep
