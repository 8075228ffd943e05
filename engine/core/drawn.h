// What can be drawn of a state besides points, lines and triangles: solids in space, solids that rows of a
// system carry, and marks (contacts, joints) that a picture shows on request. Sizes in m, orientations are
// unit quaternions (w, x, y, z), colours sRGB in [0, 1].
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

/// Triangles in a solid's own frame, shared by everything that looks like it; immutable once made.
struct DrawnMesh {
  std::vector<float> positions;     ///< n x 3, m
  std::vector<float> normals;       ///< n x 3, unit, outward
  std::vector<uint32_t> triangles;  ///< 3 each, anticlockwise seen from outside
};

/// A solid to draw.
struct DrawnShape {
  enum class Kind : uint8_t { plane, box, sphere, capsule, cylinder, mesh } kind = Kind::sphere;
  Vec3 position;
  std::array<double, 4> orientation{1, 0, 0, 0};
  Vec3 size;  ///< plane: unit normal; box: half extents; sphere: (r, -, -); capsule and cylinder: (r, half
              ///< length along y, -), a capsule's ends come on top; mesh: unused
  std::string id;
  bool container = false;  ///< points stay inside instead of outside
  std::shared_ptr<const DrawnMesh> mesh = {};
};

/// Solids that move with rows of a system's fields "position" (m) and "orientation".
struct DrawnBodies {
  enum class Motion : uint8_t { fixed, driven, moving, sensor };
  struct Form {
    DrawnShape shape;  ///< position and orientation in the row's frame
    std::optional<std::array<double, 3>> color;
    uint32_t group = 0;  ///< forms of one group look alike where they have no colour
    Motion motion = Motion::moving;
  };
  std::vector<Form> forms;
  std::vector<std::array<uint32_t, 2>> places;  ///< row, form
};

/// A point where bodies touch.
struct ContactMark {
  Vec3 point, normal;  ///< m; unit, towards the second body
  double force = 0;    ///< N along the normal, over the last step
};

/// A joint between bodies, or a body and the world.
struct JointMark {
  enum class Kind : uint8_t { ball, hinge, slider, fixed, distance, other } kind = Kind::other;
  Vec3 a, b;  ///< m, where the two ends are
  Vec3 axis;  ///< unit; zero where the joint has none
};

}  // namespace truestep
