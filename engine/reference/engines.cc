#include "engine/reference/engines.h"

#include "engine/base/errors.h"
#include "engine/reference/box2d.h"
#include "engine/reference/bullet.h"
#include "engine/systems/rigid2d/rigid2d.h"
#include "engine/systems/rigid3d/rigid3d_def.h"

namespace truestep {
namespace {

[[maybe_unused, noreturn]] void not_in_this_build(const std::string& name, const std::string& package) {
  throw Error("scene_invalid", "this build has no " + name,
              {"/engine", "not_built", "this build was made without " + name + " (Debian's " + package + ")",
               '"' + name + '"', "truestep", "", ""});
}

}  // namespace

std::unique_ptr<const System> build_rigid3d_engine(const void* def, const BuildContext& context) {
  const auto& d = *static_cast<const rigid3d::Rigid3dDef*>(def);
  if (d.engine == rigid3d::Rigid3dDef::Engine::truestep) return rigid3d::build_rigid3d(def, context);
#ifdef TRUESTEP_BULLET
  return build_bullet(d, context);
#else
  not_in_this_build("bullet", "libbullet-dev");
#endif
}

std::unique_ptr<const System> build_rigid2d_engine(const void* def, const BuildContext& context) {
  const auto& d = *static_cast<const rigid2d::Rigid2dDef*>(def);
  if (d.engine == rigid2d::Rigid2dDef::Engine::truestep) return rigid2d::build_rigid2d(def, context);
#ifdef TRUESTEP_BOX2D
  return build_box2d(d, context);
#else
  not_in_this_build("box2d", "libbox2d-dev");
#endif
}

}  // namespace truestep
