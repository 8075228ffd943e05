// What is drawn of a state besides its fields: lines and triangles between rows, solids attached to rows,
// obstacles, and marks (contacts, joints) on request. Sizes in m, orientations are unit quaternions (w, x, y,
// z), colours sRGB in [0, 1].
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

/// What is requested of a drawing; a set of bits.
enum class Wish : uint8_t { none = 0, constant = 1, obstacles = 2, contacts = 4, joints = 8, marks = 12 };
constexpr Wish operator|(Wish a, Wish b) {
  return static_cast<Wish>(static_cast<uint8_t>(a) | static_cast<uint8_t>(b));
}
constexpr bool wants(Wish wishes, Wish one) {
  return (static_cast<uint8_t>(wishes) & static_cast<uint8_t>(one)) != 0;
}
constexpr Wish without(Wish wishes, Wish one) {
  return static_cast<Wish>(static_cast<uint8_t>(wishes) & ~static_cast<unsigned>(one));
}

/// How a scalar is mapped to a colour, from its smallest to its largest value. `automatic` is what suits the
/// field: `balance` for deviations to both sides of zero, otherwise viridis.
enum class ColorMap : uint8_t { automatic, viridis, water, ember, balance, smoke, snow, sand };

/// Triangles in a solid's own frame, shared by all solids that look alike; immutable.
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

/// The look of a solid attached to rows of a part.
struct Visual {
  enum class Motion : uint8_t { fixed, kinematic, dynamic, sensor };
  DrawnShape shape;  ///< position and orientation in the row's frame
  std::optional<std::array<double, 3>> color;
  uint32_t group = 0;  ///< visuals of one group look alike when they have no colour of their own
  Motion motion = Motion::dynamic;
};

/// One axis of a plot: the value shown and where that value is drawn.
struct PlotAxis {
  std::string name;              ///< of the value: a state, "t" for time, or a formula of several
  std::string unit;              ///< empty: none is known
  double slope = 1, offset = 0;  ///< m; a value v is drawn at offset + slope v
  /// Powers of ten and where they are drawn (m), ascending; for an axis whose values are not evenly spaced.
  std::vector<std::array<double, 2>> decades;
};

enum class LineKind : uint8_t { structural = 0, shear = 1, bending = 2, other = 3 };

/// What is drawn for the rows of a part, until the drawing's version changes.
struct PartDrawing {
  std::vector<std::array<uint32_t, 2>> lines;
  std::vector<LineKind> line_kinds;  ///< one per line, or empty
  std::vector<std::array<uint32_t, 3>> triangles;
  /// One per triangle: the row of values that it shows (PartInfo::elements); empty: its own number.
  std::vector<uint32_t> triangle_elements;
  double point_radius = 0;                     ///< m; 0: points are not drawn as spheres
  std::optional<std::array<double, 3>> color;  ///< r g b in [0, 1]
  std::vector<Visual> visuals;
  /// Row, visual. The row's pose is its position and orientation; sleeping rows are dimmed.
  std::vector<std::array<uint32_t, 2>> instances;
  /// Whether everything lies in the plane z = 0 and is viewed along z.
  enum class Space : uint8_t { solid, plane } space = Space::solid;
  /// Axes along x, y and optionally z, when rows are a plot; its lines are the curves.
  std::vector<PlotAxis> plot;
  std::vector<std::string> curves;  ///< one name per curve, in the lines' order, when curves are named
};

/// An end of a string: a point in the world, or in the frame of a row that has a position.
struct StringEnd {
  static constexpr uint32_t kWorld = ~0u;
  uint32_t part = kWorld;
  uint32_t row = 0;
  Vec3 at;  ///< m
};

/// Something that connects two things and has no shape of its own: a distance joint, a spring, an attachment.
struct DrawnString {
  StringEnd a, b;
};

/// A point where bodies touch.
struct ContactMark {
  Vec3 point, normal;  ///< m; unit, towards the second body
  double force = 0;    ///< N along the normal, over the last step
};

/// A joint between two bodies, or a body and the world.
struct JointMark {
  enum class Kind : uint8_t { spherical, revolute, prismatic, fixed, distance, other } kind = Kind::other;
  Vec3 a, b;  ///< m, positions of the two ends
  Vec3 axis;  ///< unit; zero where the joint has none
  static constexpr uint32_t kNoRow = ~0u;
  uint32_t row = kNoRow;  ///< its row among the values of the system's joints (PartInfo::elements)
  uint32_t part = 0;      ///< of these values
};

/// What was requested; the rest is empty.
struct Drawing {
  uint32_t version = 1;               ///< of the constant part, set whatever is requested
  std::vector<PartDrawing> parts;     ///< one per part: the constant part of the drawing
  std::vector<DrawnString> strings;   ///< part of the constant drawing; their rows hold until its version
                                      ///< changes
  std::vector<DrawnShape> obstacles;  ///< at their positions at the time of the state
  std::vector<ContactMark> contacts;
  std::vector<JointMark> joints;
};

}  // namespace truestep
