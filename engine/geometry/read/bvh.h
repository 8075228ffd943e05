// Motion in the BVH format: a HIERARCHY of joints with offsets and channels, then MOTION with frames of
// channel values, lengths in the file's own unit, angles in degrees. A joint's rotation is the product of its
// rotation channels in the order in which they are named, the first outermost; any order and any number of up
// to six channels is read, including positions of joints other than the root. Anything else is a fault with
// its line.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/geometry/shape.h"

namespace truestep {

/// A text that is not valid BVH; lines count from 1.
class BvhFault : public std::runtime_error {
 public:
  BvhFault(size_t at_line, const std::string& message)
      : std::runtime_error("line " + std::to_string(at_line) + ": " + message), line(at_line) {}
  size_t line;
};

enum class BvhChannel : uint8_t { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };

struct BvhJoint {
  std::string name;
  int32_t parent = -1;
  Vec3 offset;
  std::vector<BvhChannel> channels;
  size_t first_channel = 0;
  std::optional<Vec3> end;  ///< offset of its End Site
};

struct BvhMotion {
  std::vector<BvhJoint> joints;  ///< parents first; exactly one without a parent
  size_t channels = 0;           ///< in total over all joints
  size_t frames = 0;
  double frame_time = 1.0 / 30;  ///< s
  std::vector<double> values;    ///< frames x channels, the file's units and degrees

  /// The joint in its parent's frame: its offset, or its position channels if it has any, and its rotation
  /// channels.
  Pose local(size_t frame, size_t joint) const;
};

/// Throws BvhFault.
BvhMotion read_bvh(std::span<const std::string> lines);
/// A text that reads back as the same motion, to the bit.
std::string write_bvh(const BvhMotion& motion);

}  // namespace truestep
