// Which engine steps a rigid scene: our own solver, or another one behind the same System ("engine":
// "bullet", "box2d"). Anything without an equivalent there is refused with a pointer to the value; an engine
// that is not part of this build is refused at "/engine".
#pragma once
#include <memory>

#include "engine/core/def/build.h"
#include "engine/core/system.h"

namespace truestep {

/// From a Rigid3dDef. Errors as build_rigid3d, and "scene_invalid" for anything that the named engine cannot
/// do.
std::unique_ptr<const System> build_rigid3d_engine(const void* def, const BuildContext& context);
/// From a rigid2d::Rigid2dDef, likewise.
std::unique_ptr<const System> build_rigid2d_engine(const void* def, const BuildContext& context);

}  // namespace truestep
