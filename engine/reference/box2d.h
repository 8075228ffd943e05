// A rigid2d scene stepped by Box2D 2.4.1: same state, fields, observables and commands as our own system,
// another solver (sequential impulses in floats, 8 iterations for velocities and 3 for positions a step;
// small steps, softness and precision of the scene do not apply). Shapes have their own size: Box2D's usual
// skin of 1 cm is left out. Nothing moves faster than 2 m in a step, which is the library's own bound. What
// it remembers of contacts lies in the workspace: whenever the state is not the one that the last step wrote,
// its world is built again from poses and velocities, and contacts start without the impulses of the step
// before. Source: E. Catto, Box2D 2.4.1 (MIT licence).
#pragma once
#include <memory>

#include "engine/core/build.h"
#include "engine/core/system.h"
#include "engine/systems/rigid2d/rigid2d_def.h"

namespace truestep {

/// Error "scene_invalid" with pointers for what Box2D has no equivalent of.
std::unique_ptr<const System> build_box2d(const rigid2d::Rigid2dDef& def, const BuildContext& context);

}  // namespace truestep
