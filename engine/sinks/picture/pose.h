// The pose of a shape: its position and the columns of its rotation matrix.
#pragma once
#include <cmath>

#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep::picture {

/// A shape's own axes in the scene; an invalid quaternion counts as no rotation.
struct Pose {
  Vec3 position;
  Vec3 axis[3];  ///< the shape's x, y, z in the scene

  explicit Pose(const DrawShape& s) : position(s.position) {
    double w = s.orientation[0], x = s.orientation[1], y = s.orientation[2], z = s.orientation[3];
    const double n = std::sqrt(w * w + x * x + y * y + z * z);
    if (n > 0 && std::isfinite(n)) {
      w /= n, x /= n, y /= n, z /= n;
    } else {
      w = 1, x = y = z = 0;
    }
    axis[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
    axis[1] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
    axis[2] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
  }
  Vec3 direction(const Vec3& v) const { return axis[0] * v.x + axis[1] * v.y + axis[2] * v.z; }
  Vec3 point(const Vec3& v) const { return position + direction(v); }
};

}  // namespace truestep::picture
