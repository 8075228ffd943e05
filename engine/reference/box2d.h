// A rigid2d scene stepped by Box2D 2.4.1: same state, fields, observables and commands as our own system, but
// another solver (sequential impulses in floats, 8 velocity and 3 position iterations per step; the scene's
// substeps, softness and precision do not apply). Shapes have their true size, without Box2D's usual 1 cm
// skin. Nothing moves more than 2 m per step, which is the library's own bound. Its contact cache lives in
// the workspace: whenever the state is not the one written by the last step, its world is rebuilt from poses
// and velocities, and contacts start without the impulses of the previous step. Source: E. Catto, Box2D 2.4.1
// (MIT licence).
#pragma once
#include <memory>

#include "engine/core/def/build.h"
#include "engine/core/system.h"
#include "engine/systems/rigid2d/rigid2d_def.h"

namespace truestep {

/// Error "scene_invalid" with pointers for everything that Box2D has no equivalent of.
std::unique_ptr<const System> build_box2d(const rigid2d::Rigid2dDef& def, const BuildContext& context);

}  // namespace truestep
