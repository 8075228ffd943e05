#include "engine/sinks/motion/session_motion.h"

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/core/ports/rig_port.h"

namespace truestep {

namespace {

bool holds(MotionFormat format, const System& system) {
  if (format != MotionFormat::bvh) return MotionExport::suits(system);
  const auto rig = rig_of(system);
  return rig && std::ranges::count_if(rig->joints, [](const auto& j) { return j.parent < 0; }) == 1;
}

}  // namespace

size_t motion_system(const World& world, std::string_view id, MotionFormat format,
                     const std::string& pointer) {
  std::string suitable;
  for (size_t i = 0; i < world.size(); ++i) {
    if (!holds(format, world.system(i))) continue;
    if (id.empty() || id == world.id(i)) return i;
    suitable += (suitable.empty() ? "" : ", ") + world.id(i);
  }
  const std::string what = format == MotionFormat::bvh ? "joints under one root" : "joints or blended shapes";
  const std::string why =
      suitable.empty() ? "nothing in the scene has " + what : "nothing with " + what + " has this id";
  throw Error("unknown_system", why,
              {pointer, "unknown_system", why, '"' + std::string(id.substr(0, 60)) + '"',
               suitable.empty() ? "a scene with " + what : suitable, "", ""});
}

std::string write_motion(const MotionExport& file, MotionFormat format) {
  switch (format) {
    case MotionFormat::bvh:
      return file.bvh();
    case MotionFormat::gltf:
      return file.gltf();
    case MotionFormat::glb:
      break;
  }
  return file.glb();
}

}  // namespace truestep
