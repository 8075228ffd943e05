// Which system's motion a file holds, and the steps of its frames: frame k is the step nearest to t_0 + k /
// rate. Shared by the command line, which runs a scene, and the service, which recomputes a session's past.
#pragma once
#include <cmath>

#include "engine/session/session.h"
#include "engine/sinks/motion/motion_export.h"

namespace truestep {

enum class MotionFormat : uint8_t { bvh, gltf, glb };
/// The first system whose motion such a file holds, or that of this id: joints or blended shapes, for BVH
/// joints under one root. Error "unknown_system" with this pointer where there is none.
size_t motion_system(const World& world, std::string_view id, MotionFormat format,
                     const std::string& pointer);
std::string write_motion(const MotionExport& file, MotionFormat format);

/// Frames of `rate` (1/s) from the step `first` on.
struct FrameSteps {
  uint64_t first = 0;
  double rate = 30, dt = 0.01;

  uint64_t step(uint64_t frame) const {
    return first + static_cast<uint64_t>(std::llround(static_cast<double>(frame) / rate / dt));
  }
  /// Number of frames within `seconds`.
  uint64_t count(double seconds) const {
    return static_cast<uint64_t>(std::floor(seconds * rate + 1e-9)) + 1;
  }
};

}  // namespace truestep
